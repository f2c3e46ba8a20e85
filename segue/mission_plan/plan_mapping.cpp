// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_plan/plan_mapping.hpp>

#include <segue/base/names_of.hpp>
#include <segue/base/text.hpp>
#include <segue/mission/mission_file_parts.hpp>
#include <segue/mission/mission_io.hpp>

#include <algorithm>

namespace segue::mission {

using detail::Fields;
using detail::Source;
using type::Value;

namespace {

bool has_parameter(const std::vector<pddl::DomainParameter>& parameters, std::string_view name) {
  return std::ranges::find(parameters, name, &pddl::DomainParameter::name) != parameters.end();
}

class MappingReader {
 public:
  MappingReader(PlanMapping& mapping, const Source& source) : mapping_(mapping), source_(source) {}

  void read(const Value& root) {
    Fields fields(root, "the mapping", source_);
    mapping_.name = fields.required_name("plan_mapping", "give it a name");
    if (!read_domain(fields)) return;
    read_library(fields);
    for (ObservedFact& fact : detail::read_observed(fields, source_))
      mapping_.library.observed.push_back(std::move(fact));
    read_objects(fields);
    read_facts(fields);
    read_actions(fields);
    fields.finish();
  }

 private:
  std::filesystem::path beside(const std::string& name) {
    return std::filesystem::path(mapping_.file).parent_path() / name;
  }

  bool read_domain(Fields& fields) {
    if (fields.require("domain", "name the PDDL file of the domain") == nullptr) return false;
    mapping_.domain_file = beside(fields.text("domain"));
    auto text = model::detail::read_text(mapping_.domain_file, source_.diagnostics());
    if (!text) return false;
    mapping_.domain_text = std::move(*text);
    auto domain =
        pddl::read_domain({mapping_.domain_text, mapping_.domain_file.string()}, source_.diagnostics());
    if (domain) mapping_.domain = std::move(*domain);
    return domain.has_value();
  }

  void read_library(Fields& fields) {
    if (fields.find("library") == nullptr) return;
    const std::filesystem::path file = beside(fields.text("library"));
    const auto text = model::detail::read_text(file, source_.diagnostics());
    auto library = text ? read_mission(*text, file.string(), source_.diagnostics()) : std::nullopt;
    if (library) mapping_.library = std::move(*library);
  }

  void read_objects(Fields& fields) {
    const Value* types = fields.find("objects", Value::Kind::Map);
    if (types == nullptr) return;
    for (const auto& [type, values] : types->as_map()) {
      if (!mapping_.domain.facts.has_type(type))
        source_.error("unknown-type", "the domain has no type " + quote(type), values);
      if (!values.is_map()) {
        source_.error("wrong-kind", "type " + quote(type) + ": expected a map of objects and their values",
                      values);
        continue;
      }
      ObjectValues& entry = mapping_.objects.emplace_back();
      entry.type = type;
      entry.where = source_.at(values);
      for (const auto& [object, value] : values.as_map())
        entry.values.push_back({object, value, source_.at(value)});
    }
  }

  void read_facts(Fields& fields) {
    const Value* facts = fields.find("facts", Value::Kind::Map);
    if (facts == nullptr) return;
    for (const auto& [name, value] : facts->as_map()) {
      const auto& predicates = mapping_.domain.predicates;
      const auto known = std::ranges::find(predicates, name, &pddl::DomainPredicate::name);
      if (known == predicates.end()) {
        source_.error("unknown-predicate",
                      "the domain has no predicate " + quote(name) + did_you_mean(name, names_of(predicates)),
                      value);
        continue;
      }
      auto fact = parse_fact(model::detail::scalar_text(value).value_or(""), "!");
      if (!fact) {
        source_.error(
            "bad-fact",
            "predicate " + quote(name) + ": expected a fact such as 'at(robot, {place})' or '!full()'",
            value);
        continue;
      }
      for (const std::string& argument : fact->arguments)
        check_parameters("predicate " + quote(name), known->parameters, placeholders(argument), value);
      mapping_.predicates.push_back({name, std::move(*fact)});
    }
  }

  void check_parameters(const std::string& what, const std::vector<pddl::DomainParameter>& parameters,
                        const std::vector<std::string>& named, const Value& at) {
    for (const std::string& name : named) {
      if (has_parameter(parameters, name)) continue;
      source_.error("unknown-parameter",
                    what + " has no parameter " + quote(name) + did_you_mean(name, names_of(parameters)), at);
    }
  }

  void read_actions(Fields& fields) {
    const Value* actions = fields.find("actions", Value::Kind::Map);
    const auto& known = mapping_.domain.actions;
    if (actions != nullptr) {
      for (const auto& [name, value] : actions->as_map()) {
        const auto found = std::ranges::find(known, name, &pddl::DomainAction::name);
        if (found == known.end()) {
          source_.error("unknown-action",
                        "the domain has no action " + quote(name) + did_you_mean(name, names_of(known)),
                        value);
        } else {
          read_action(*found, value);
        }
      }
    }
    for (const pddl::DomainAction& action : known) {
      if (mapping_.find_action(action.name) == nullptr && !source_.diagnostics().has_errors())
        source_.warning("unbound-action",
                        "nothing carries out the action " + quote(action.name) +
                            " of the domain: plans with it "
                            "are refused",
                        fields.value());
    }
  }

  void read_action(const pddl::DomainAction& known, const Value& value) {
    const bool names_one = value.is_map() && value.find("action") != nullptr;
    if (names_one) return read_use(known, value);
    BoundAction& bound = mapping_.actions.emplace_back();
    bound.name = known.name;
    bound.where = source_.at(value);
    bound.action = detail::read_action(known.name, value, source_);
    for (const pddl::DomainParameter& parameter : known.parameters) {
      const auto& inputs = bound.action.inputs;
      if (std::ranges::find(inputs, parameter.name, &Port::name) == inputs.end())
        bound.action.inputs.push_back(
            {.name = parameter.name, .type = "any", .value = {}, .where = bound.where});
      bound.inputs.push_back({parameter.name, "{" + parameter.name + "}", bound.where});
    }
  }

  void read_use(const pddl::DomainAction& known, const Value& value) {
    Fields fields(value, "action " + quote(known.name), source_);
    BoundAction bound;
    bound.name = known.name;
    bound.where = source_.at(value);
    const std::string name = fields.text("action");
    bound.inputs = detail::read_values(fields, "inputs", source_);
    const std::string outcome = fields.text("outcome");
    fields.finish();
    std::vector<std::string> names;
    const Action* found = nullptr;
    for (const Action& action : mapping_.library.actions) {
      names.push_back(action.name.str());
      if (action.name.str() == name) found = &action;
    }
    if (found == nullptr) {
      return source_.error(
          "unknown-action",
          fields.what() + ": the library has no action " + quote(name) + did_you_mean(name, names),
          *value.find("action"));
    }
    bound.action = *found;
    check_inputs(known, bound, value);
    if (!outcome.empty()) {
      if (std::ranges::find(found->outcomes, outcome) == found->outcomes.end())
        source_.error("unknown-outcome",
                      fields.what() + ": " + quote(name) + " has no outcome " + quote(outcome),
                      *value.find("outcome"));
      bound.action.expected_outcome = outcome;
    }
    mapping_.actions.push_back(std::move(bound));
  }

  void check_inputs(const pddl::DomainAction& known, const BoundAction& bound, const Value& value) {
    const std::string what = "action " + quote(known.name);
    const Value* inputs = value.find("inputs");
    for (const PortValue& input : bound.inputs) {
      const Value& at = *inputs->find(input.port);
      check_parameters(what, known.parameters, inputs_named_in(input.value), at);
      const auto port = std::ranges::find(bound.action.inputs, input.port, &Port::name);
      if (port == bound.action.inputs.end()) {
        source_.error("unknown-input",
                      what + ": " + quote(bound.action.name.str()) + " has no input " + quote(input.port) +
                          did_you_mean(input.port, names_of(bound.action.inputs)),
                      at);
      } else if (const auto parameter = parameter_input(input.value)) {
        check_values(known, *parameter, *port);
      }
    }
    for (const Port& port : bound.action.inputs) {
      const bool given = std::ranges::find(bound.inputs, port.name, &PortValue::port) != bound.inputs.end();
      if (!given && port.value.is_null())
        source_.error("missing-input", what + ": nothing gives the input " + quote(port.name) + " a value",
                      value);
    }
  }

  /// The values of a parameter's objects must be of the type of the input.
  void check_values(const pddl::DomainAction& known, std::string_view name, const Port& port) {
    const auto parameter = std::ranges::find(known.parameters, name, &pddl::DomainParameter::name);
    if (parameter == known.parameters.end()) return;
    for (const ObjectValues& objects : mapping_.objects) {
      if (std::ranges::find(parameter->types, objects.type) == parameter->types.end()) continue;
      for (const PortValue& object : objects.values) {
        if (accepts(port.type, object.value)) continue;
        source_.diagnostics().error("type-mismatch",
                                    "action " + quote(known.name) + ": the input " + quote(port.name) +
                                        " takes " + port.type + ", but the object " + quote(object.port) +
                                        " is " + type::describe(object.value),
                                    object.where);
      }
    }
  }

  PlanMapping& mapping_;
  const Source& source_;
};

}  // namespace

const BoundAction* PlanMapping::find_action(std::string_view of) const {
  const auto found = std::ranges::find(actions, of, &BoundAction::name);
  return found == actions.end() ? nullptr : &*found;
}

const BoundPredicate* PlanMapping::find_predicate(std::string_view of) const {
  const auto found = std::ranges::find(predicates, of, &BoundPredicate::name);
  return found == predicates.end() ? nullptr : &*found;
}

namespace {

/// The objects by which the pattern becomes the fact, in the order of the predicate's parameters.
std::optional<std::vector<std::string>> objects_in(const Fact& pattern, const Fact& fact,
                                                   const pddl::DomainPredicate& predicate) {
  if (pattern.predicate != fact.predicate || pattern.arguments.size() != fact.arguments.size())
    return std::nullopt;
  std::vector<std::string> objects(predicate.parameters.size());
  for (std::size_t i = 0; i < fact.arguments.size(); ++i) {
    const auto name = parameter_input(pattern.arguments[i]);
    const auto parameter = name ? std::ranges::find(predicate.parameters, *name, &pddl::DomainParameter::name)
                                : predicate.parameters.end();
    if (parameter == predicate.parameters.end()) {
      if (pattern.arguments[i] != fact.arguments[i]) return std::nullopt;
      continue;
    }
    std::string& object = objects[static_cast<std::size_t>(parameter - predicate.parameters.begin())];
    if (!object.empty() && object != fact.arguments[i]) return std::nullopt;
    object = fact.arguments[i];
  }
  if (std::ranges::find(objects, "") != objects.end()) return std::nullopt;
  return objects;
}

}  // namespace

std::optional<pddl::GroundAtom> observed_atom(const PlanMapping& mapping, const Fact& fact, bool holds) {
  for (const pddl::DomainPredicate& predicate : mapping.domain.predicates) {
    Fact same;
    same.predicate = predicate.name;
    for (const pddl::DomainParameter& parameter : predicate.parameters)
      same.arguments.push_back("{" + parameter.name + "}");
    const BoundPredicate* const bound = mapping.find_predicate(predicate.name);
    const Fact& pattern = bound == nullptr ? same : bound->fact;
    const auto objects = objects_in(pattern, fact, predicate);
    if (!objects) continue;
    pddl::GroundAtom atom{{predicate.name}, holds == pattern.positive};
    atom.words.insert(atom.words.end(), objects->begin(), objects->end());
    return atom;
  }
  return std::nullopt;
}

std::optional<PlanMapping> load_mapping(const std::filesystem::path& file, Diagnostics& diagnostics) {
  const std::size_t errors_before = diagnostics.error_count();
  const auto text = model::detail::read_text(file, diagnostics);
  if (!text) return std::nullopt;
  const Source source(file.string(), diagnostics);
  const auto root = source.parse(*text);
  if (!root) return std::nullopt;
  std::optional<PlanMapping> mapping(std::in_place);
  mapping->file = file.string();
  MappingReader(*mapping, source).read(*root);
  if (diagnostics.error_count() > errors_before) return std::nullopt;
  return mapping;
}

}  // namespace segue::mission
