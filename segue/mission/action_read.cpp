// SPDX-License-Identifier: Apache-2.0
#include <segue/base/likelihood.hpp>
#include <segue/base/text.hpp>
#include <segue/mission/footprint.hpp>
#include <segue/mission/mission_file_parts.hpp>

#include <algorithm>
#include <limits>

namespace segue::mission::detail {

using type::Value;

bool check_free_name(std::string_view name, std::string_view what, const Value& at, const Source& source) {
  const bool fits = !name.empty() && name.size() <= 255 && std::ranges::none_of(name, [](char c) {
    return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
  });
  if (fits) return true;
  source.error("bad-name",
               std::string(what) + ": " + quote(name) + " is not a name: it must be one line of text", at);
  return false;
}

namespace {

Port read_port(const std::string& name, const Value& value, const std::string& what, const Source& source) {
  Port port;
  port.name = name;
  port.where = source.at(value);
  check_free_name(name, what, value, source);
  if (value.is_null()) return port;
  if (!value.is_map()) {
    if (const auto type = model::detail::scalar_text(value)) {
      port.type = *type;
      return port;
    }
  }
  Fields fields(value, what + " " + quote(name), source);
  const std::string type = fields.text("type");
  if (!type.empty()) port.type = type;
  if (const Value* given = fields.find("default")) port.value = *given;
  fields.finish();
  return port;
}

void read_fact(std::vector<Fact>& facts, const Value& item, const Fields& fields, std::string_view key,
               std::string_view signs, const Source& source) {
  auto fact = item.is_string() ? parse_fact(item.as_string(), signs) : std::nullopt;
  if (!fact) {
    return source.error(
        "bad-fact",
        fields.what() + ": " + quote(key) + " must be facts such as " +
            (signs == "!" ? "'at(robot, {place})' or '!held(cup)'" : "'+held(cup)' or '-at(cup, table)'") +
            ", got " + type::describe(item),
        item);
  }
  fact->where = source.at(item);
  facts.push_back(std::move(*fact));
}

void read_facts(std::vector<Fact>& facts, Fields& fields, std::string_view key, std::string_view signs,
                const Source& source) {
  const Value* list = fields.find(key, Value::Kind::List);
  if (list == nullptr) return;
  for (const Value& item : list->as_list())
    read_fact(facts, item, fields, key, signs, source);
}

/// {block: arm} or {consume: "cup_{n}", count: 2, parameters: {...}}: the operation is the key.
void read_use(std::vector<ResourceUse>& uses, const Value& item, const std::string& what,
              const Source& source) {
  Fields fields(item, "a resource of " + what, source);
  if (!item.is_map()) {
    if (item.is_null())
      source.error("wrong-kind", fields.what() + ": expected a map such as {block: arm}", item);
    return;
  }
  ResourceUse use;
  use.where = source.at(item);
  int operations = 0;
  for (std::size_t i = 0; i < kResourceOperationNames.size(); ++i) {
    if (fields.find(kResourceOperationNames[i]) == nullptr) continue;
    ++operations;
    use.operation = static_cast<ResourceOperation>(i);
    use.resource = fields.text(kResourceOperationNames[i]);
    check_free_name(use.resource, fields.what(), item, source);
  }
  constexpr std::int64_t kMost = std::numeric_limits<int>::max();
  use.count = static_cast<int>(fields.integer("count", 1, kMost, "bad-count").value_or(1));
  if (const Value* parameters = fields.find("parameters", Value::Kind::Map)) use.parameters = *parameters;
  use.keep = fields.boolean("keep", false);
  fields.finish();
  if (use.keep && use.operation != ResourceOperation::Block) {
    source.error("bad-resource",
                 fields.what() + ": only units that are blocked can be kept, as in {block: arm, keep: true}",
                 item);
  }
  if (operations != 1) {
    const std::vector<std::string> names(kResourceOperationNames.begin(), kResourceOperationNames.end());
    source.error("bad-resource",
                 fields.what() + ": expected exactly one of " + listed(names) + ", as in {block: arm}", item);
  }
  uses.push_back(std::move(use));
}

Simulated read_simulated(const Value& value, const std::string& what, const Source& source) {
  Fields fields(value, "the simulation of " + what, source);
  Simulated simulated;
  simulated.duration = fields.duration("duration").value_or(Duration::zero());
  if (simulated.duration < Duration::zero()) {
    source.error("bad-duration", fields.what() + ": 'duration' must not be negative", value);
  }
  simulated.outcomes = fields.texts("outcomes");
  simulated.outputs = read_values(fields, "outputs", source);
  simulated.error = fields.text("error");
  fields.finish();
  return simulated;
}

Decision read_decision(const Value& value, const std::string& what, const Source& source) {
  Decision decision;
  if (!value.is_list()) {
    source.error("wrong-kind", what + ": 'decide' must be a list of rules, got " + type::describe(value),
                 value);
    return decision;
  }
  for (const Value& item : value.as_list()) {
    Fields fields(item, "a rule of " + what, source);
    DecisionRule rule;
    if (const Value* when = fields.find("when", Value::Kind::Map)) {
      for (const auto& [state, outcome] : when->as_map())
        rule.when.emplace_back(state, model::detail::scalar_text(outcome).value_or(""));
    }
    fields.require("outcome");
    rule.outcome = fields.text("outcome");
    fields.finish();
    decision.rules.push_back(std::move(rule));
  }
  return decision;
}

void read_likelihoods(Action& action, Fields& expect, const Source& source) {
  const Value* value = expect.find("likelihood", Value::Kind::Map);
  if (value == nullptr) return;
  double sum = 0;
  for (const auto& [outcome, likelihood] : value->as_map()) {
    if (!likelihood.is_number() || !is_likelihood(likelihood.as_double())) {
      source.error("bad-likelihood",
                   expect.what() + ": the likelihood of " + quote(outcome) +
                       " must be a number between 0 and 1, got " + type::describe(likelihood),
                   likelihood);
      return;
    }
    sum += likelihood.as_double();
    action.likelihoods.push_back({outcome, likelihood.as_double()});
  }
  if (sum > 1 + 1e-9)
    source.error("bad-likelihood", expect.what() + ": the likelihoods of all outcomes exceed 1 in sum",
                 *value);
}

void read_expectation(Action& action, Fields& fields, const Source& source) {
  const Value* value = fields.find("expect", Value::Kind::Map);
  if (value == nullptr) return;
  Fields expect(*value, "'expect' of " + fields.what(), source);
  action.expected_duration = expect.duration("duration");
  if (action.expected_duration.value_or(Duration::zero()) < Duration::zero())
    source.error("bad-duration", expect.what() + ": 'duration' must not be negative", *value);
  action.expected_outcome = expect.text("outcome");
  read_likelihoods(action, expect, source);
  expect.finish();
}

}  // namespace

std::vector<Port> read_ports(Fields& fields, std::string_view key, const Source& source) {
  std::vector<Port> ports;
  const Value* value = fields.find(key, Value::Kind::Map);
  if (value == nullptr) return ports;
  for (const auto& [name, port] : value->as_map())
    ports.push_back(read_port(name, port, fields.what() + ": " + quote(key), source));
  return ports;
}

std::vector<Fact> read_world(Fields& fields, const Source& source) {
  std::vector<Fact> facts;
  const Value* list = fields.find("world", Value::Kind::List);
  if (list == nullptr) return facts;
  for (const Value& item : list->as_list()) {
    auto fact = item.is_string() ? parse_fact(item.as_string(), "") : std::nullopt;
    if (!fact || !ground(*fact)) {
      source.error("bad-fact",
                   fields.what() + ": 'world' must be facts that hold at the beginning, such as " +
                       "'at(robot, dock)', without signs and inputs, got " + type::describe(item),
                   item);
      continue;
    }
    fact->where = source.at(item);
    facts.push_back(std::move(*fact));
  }
  return facts;
}

std::vector<PortValue> read_values(Fields& fields, std::string_view key, const Source& source) {
  std::vector<PortValue> values;
  const Value* value = fields.find(key, Value::Kind::Map);
  if (value == nullptr) return values;
  for (const auto& [name, given] : value->as_map()) {
    check_free_name(name, fields.what() + ": " + quote(key), given, source);
    values.push_back({name, given, source.at(given)});
  }
  return values;
}

std::vector<std::string> read_outcomes(Fields& fields, const Source& source) {
  const Value* value = fields.find("outcomes");
  if (value == nullptr) return {"success"};
  std::vector<std::string> outcomes;
  for (std::string& outcome : fields.texts("outcomes")) {
    check_free_name(outcome, fields.what() + ": 'outcomes'", *value, source);
    if (outcome == kAbortedName || outcome == kPreemptedName) {
      source.error("bad-name", fields.what() + ": every state has the outcome " + quote(outcome) + " anyway",
                   *value);
    } else if (std::ranges::find(outcomes, outcome) != outcomes.end()) {
      source.error("duplicate-outcome", fields.what() + " has the outcome " + quote(outcome) + " twice",
                   *value);
    }
    outcomes.push_back(std::move(outcome));
  }
  return outcomes;
}

void read_needs(std::vector<Fact>& preconditions, std::vector<ResourceUse>& resources, Fields& fields,
                const Source& source) {
  read_facts(preconditions, fields, "preconditions", "!", source);
  const Value* uses = fields.find("resources", Value::Kind::List);
  if (uses == nullptr) return;
  for (const Value& item : uses->as_list())
    read_use(resources, item, fields.what(), source);
}

namespace {

/// {scene.arm: "{goal}"}: data and the values that take their place, in this order.
void read_changes(std::vector<DataChange>& changes, const Value& map, const Source& source) {
  for (const auto& [field, value] : map.as_map())
    changes.push_back({field, value, source.at(value)});
}

/// Facts, and maps of data with their new values.
void read_effects(Action& action, Fields& fields, const Source& source) {
  const Value* list = fields.find("effects", Value::Kind::List);
  if (list == nullptr) return;
  for (const Value& item : list->as_list()) {
    if (item.is_map())
      read_changes(action.changes, item, source);
    else
      read_fact(action.effects, item, fields, "effects", "+-", source);
  }
}

/// true, or a list of the data that it looks at.
void read_what_it_looks_at(Action& action, Fields& fields) {
  const Value* value = fields.find("reads_world");
  if (value != nullptr && value->is_list())
    action.reads_data = fields.texts("reads_world");
  else
    action.reads_world = fields.boolean("reads_world", false);
}

}  // namespace

void read_declarations(Action& action, Fields& fields, const Source& source) {
  read_needs(action.preconditions, action.resources, fields, source);
  read_facts(action.during, fields, "while", "!", source);
  read_effects(action, fields, source);
  action.pure = fields.boolean("pure", false);
  action.sensing = fields.boolean("sensing", false);
  read_what_it_looks_at(action, fields);
  action.strict = fields.boolean("strict", false);
  if (fields.find("controllers", Value::Kind::List) != nullptr)
    action.controllers = fields.texts("controllers");
  read_expectation(action, fields, source);
}

Script read_script(const Value& value, const std::string& what, const Source& source) {
  Script script;
  if (const auto file = model::detail::scalar_text(value)) {
    script.file = *file;
    return script;
  }
  Fields fields(value, "the script of " + what, source);
  script.file = fields.text("file");
  script.text = fields.text("text");
  script.isolated = fields.boolean("isolated", false);
  if (const Value* text = fields.find("text")) script.where = source.at(*text);
  fields.finish();
  if (script.file.empty() == script.text.empty())
    source.error("bad-script", fields.what() + ": give either 'file' or 'text'", value);
  return script;
}

Procedure read_run(Fields& action, const Source& source) {
  const Value* value = action.find("run", Value::Kind::Map);
  if (value == nullptr) return {};
  Fields fields(*value, "'run' of " + action.what(), source);
  Procedure run;
  int ways = 0;
  if (fields.find("callback") != nullptr) {
    ++ways;
    run = Callback{fields.name("callback")};
  }
  if (const Value* script = fields.find("python")) {
    ++ways;
    run = read_script(*script, action.what(), source);
  }
  if (const Value* simulated = fields.find("simulated")) {
    ++ways;
    run = read_simulated(*simulated, action.what(), source);
  }
  if (const Value* decision = fields.find("decide")) {
    ++ways;
    run = read_decision(*decision, action.what(), source);
  }
  if (fields.find("controller") != nullptr) {
    ++ways;
    run = read_controller(fields, source);
  }
  if (fields.find("pool") != nullptr) {
    ++ways;
    run = read_pool_call(fields, source);
  }
  fields.finish();
  if (ways != 1) {
    source.error(
        "bad-run",
        fields.what() + ": expected exactly one of callback, python, simulated, decide, controller and pool",
        *value);
  }
  return run;
}

Action read_action(const std::string& name, const Value& value, const Source& source) {
  Fields fields(value, "action " + quote(name), source);
  model::detail::check_name(name, "an action", value, source);
  Action action;
  action.name = ActionName(name);
  action.where = source.at(value);
  action.description = fields.text("description");
  action.inputs = read_ports(fields, "inputs", source);
  action.outputs = read_ports(fields, "outputs", source);
  action.outcomes = read_outcomes(fields, source);
  read_declarations(action, fields, source);
  action.run = read_run(fields, source);
  fields.finish();
  return action;
}

Resource read_resource(const std::string& name, const Value& value, const Source& source) {
  Fields fields(value, "resource " + quote(name), source);
  check_free_name(name, "a resource", value, source);
  Resource resource;
  resource.name = name;
  resource.where = source.at(value);
  const auto kind = fields.choice("class", kResourceClassNames, "bad-class");
  resource.kind = static_cast<ResourceClass>(kind.value_or(0));
  constexpr std::int64_t kMost = std::numeric_limits<int>::max();
  constexpr std::array<std::string_view, 2> kOwners{"mission", "robot"};
  resource.of_robot = fields.choice("of", kOwners, "bad-owner").value_or(0) == 1;
  resource.count = static_cast<int>(
      fields.integer("count", 0, kMost, "bad-count").value_or(resource.of_robot ? Resource::kNoCount : 1));
  if (const Value* parameters = fields.find("parameters", Value::Kind::Map))
    resource.parameters = *parameters;
  resource.commutes = fields.boolean("commutes", false);
  resource.observe = read_observed_units(fields, source);
  fields.finish();
  return resource;
}

}  // namespace segue::mission::detail
