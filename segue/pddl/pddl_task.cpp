// SPDX-License-Identifier: Apache-2.0
#include <segue/pddl/pddl_task.hpp>

#include <segue/base/text.hpp>

#include <algorithm>
#include <set>

namespace segue::pddl::detail {

void PddlTask::error(std::string code, std::string message, const SourceLocation& where) {
  diagnostics_.error(std::move(code), std::move(message), where);
}

const std::vector<PddlTerm>* PddlTask::definition(const std::vector<PddlTerm>& terms, std::string_view kind) {
  const bool fine = terms.size() == 1 && terms[0].begins_with("define") && terms[0].list.size() > 1 &&
                    terms[0].list[1].begins_with(kind);
  if (fine) return &terms[0].list;
  error("bad-definition", "expected (define (" + std::string(kind) + " ...) ...)",
        terms.empty() ? SourceLocation{} : terms[0].where);
  return nullptr;
}

void PddlTask::read_domain(const std::vector<PddlTerm>& terms) {
  const auto* sections = definition(terms, "domain");
  if (sections == nullptr) return;
  if ((*sections)[1].list.size() > 1) domain_ = (*sections)[1].list[1].word;
  check_sections(
      *sections,
      {":requirements", ":types", ":constants", ":predicates", ":functions", ":action", ":durative-action"},
      {":action", ":durative-action"}, diagnostics_);
  for (const PddlTerm& section : *sections) {
    if (section.begins_with(":types")) read_types(section);
  }
  for (const PddlTerm& section : *sections) {
    if (section.begins_with(":constants")) read_constants(section);
    if (section.begins_with(":predicates")) read_predicates(section);
  }
  for (const PddlTerm& section : *sections) {
    if (section.begins_with(":action") || section.begins_with(":durative-action")) read_action(section);
  }
}

void PddlTask::read_types(const PddlTerm& section) {
  for (const PddlTyped& type : read_typed_list(section.list, 1, diagnostics_)) {
    if (type.name == task_network::FactTable::kObject) continue;
    const auto declared = network_.facts.declare_type(type.name, type.types.front());
    if (!declared) error("bad-type", declared.error().message, type.where);
  }
}

void PddlTask::read_constants(const PddlTerm& section) {
  std::set<std::string> here;
  for (const PddlTyped& constant : read_typed_list(section.list, 1, diagnostics_)) {
    if (here.insert(constant.name).second)
      declare_constant(constant);
    else
      error("bad-constant", "a second object " + quote(constant.name), constant.where);
  }
}

/// Domain and problem may both name it, with the same types.
void PddlTask::declare_constant(const PddlTyped& constant) {
  check_name(constant.name, constant.where, diagnostics_);
  const auto [known, fresh] = constants_.try_emplace(constant.name, constant.types);
  if (!fresh) {
    if (known->second != constant.types)
      error("bad-constant",
            quote(constant.name) + " is of type " + listed(known->second) + " in the domain, not " +
                listed(constant.types),
            constant.where);
    return;
  }
  const auto declared = network_.facts.declare_constant(constant.name, constant.types);
  if (declared)
    objects_.push_back(constant.name);
  else
    error("bad-constant", declared.error().message, constant.where);
}

void PddlTask::read_predicates(const PddlTerm& section) {
  for (std::size_t i = 1; i < section.list.size(); ++i) {
    const PddlTerm& predicate = section.list[i];
    if (predicate.list.empty() || predicate.list.front().word.empty()) {
      error("bad-predicate", "a predicate is a list of its name and parameters", predicate.where);
      continue;
    }
    std::vector<std::vector<std::string>> parameters;
    const auto variables = read_typed_list(predicate.list, 1, diagnostics_);
    for (const PddlTyped& variable : variables)
      parameters.push_back(variable.types);
    check_name(predicate.list.front().word, predicate.where, diagnostics_);
    arities_.emplace(predicate.list.front().word, parameters.size());
    predicates_.emplace(predicate.list.front().word, variables);
    const auto declared =
        network_.facts.declare_predicate(predicate.list.front().word, std::move(parameters));
    if (!declared) error("bad-predicate", declared.error().message, predicate.where);
  }
}

void PddlTask::read_action(const PddlTerm& section) {
  const auto& parts = section.list;
  if (parts.size() < 2 || parts[1].word.empty())
    return error("bad-action", "an action needs a name", section.where);
  check_name(parts[1].word, parts[1].where, diagnostics_);
  Action action;
  read_parts(action, section);
  std::set<std::string> names;
  for (const PddlTyped& parameter : action.parameters) {
    if (!names.insert(parameter.name).second)
      error("bad-action", "a second parameter " + quote(parameter.name), parameter.where);
    for (const std::string& type : parameter.types) {
      if (!network_.facts.has_type(type)) error("bad-type", "no type " + quote(type), parameter.where);
    }
  }
  check_action(action);
  if (!actions_.emplace(parts[1].word, std::move(action)).second)
    error("bad-action", "a second action " + quote(parts[1].word), section.where);
}

void PddlTask::check_action(const Action& action) {
  PddlForms forms(arities_, diagnostics_);
  for (const PddlTerm* part :
       {&action.condition.at_start, &action.condition.over_all, &action.condition.at_end})
    forms.check_condition(*part, action.parameters);
  for (const PddlTerm* part : {&action.effect.at_start, &action.effect.at_end})
    forms.check_effect(*part, action.parameters);
}

void PddlTask::note_changed_functions(const PddlTerm& effect) {
  if (is_numeric_effect(effect) && effect.list.size() > 1 && !effect.list[1].list.empty())
    changed_functions_.insert(effect.list[1].list.front().word);
  for (const PddlTerm& part : effect.list)
    note_changed_functions(part);
}

void PddlTask::read_parts(Action& action, const PddlTerm& section) {
  const auto& parts = section.list;
  const bool durative = section.begins_with(":durative-action");
  std::set<std::string> seen;
  for (std::size_t i = 2; i < parts.size(); i += 2) {
    const std::string& name = parts[i].word;
    if (i + 1 == parts.size()) return error("bad-action", "nothing follows " + quote(name), parts[i].where);
    if (!seen.insert(name).second) error("bad-action", "a second part " + quote(name), parts[i].where);
    const PddlTerm& part = parts[i + 1];
    if (name == ":effect") note_changed_functions(part);
    if (name == ":parameters")
      action.parameters = read_typed_list(part.list, 0, diagnostics_);
    else if (name == ":precondition" && !durative)
      action.condition.at_start = part;
    else if (name == ":effect" && !durative)
      action.effect.at_end = part;
    else if (name == ":condition" && durative)
      action.condition = timed_condition(part, diagnostics_);
    else if (name == ":effect")
      action.effect = timed_effect(part, diagnostics_);
    else if (name == ":duration" && durative)
      action.duration = part;
    else
      error("bad-action", "unknown part " + quote(name) + " of action " + quote(parts[1].word),
            parts[i].where);
  }
  if (durative && !action.duration)
    error("bad-action", "a durative action needs a ':duration' such as (= ?duration 5)", section.where);
}

PddlDomain PddlTask::domain() const {
  const auto parameters = [](const std::vector<PddlTyped>& variables) {
    std::vector<DomainParameter> result;
    for (const PddlTyped& variable : variables)
      result.push_back({variable.name.substr(variable.name.starts_with('?') ? 1 : 0), variable.types});
    return result;
  };
  PddlDomain result{domain_, {}, {}, network_.facts};
  for (const auto& [name, action] : actions_)
    result.actions.push_back({name, parameters(action.parameters), action.duration.has_value()});
  for (const auto& [name, variables] : predicates_)
    result.predicates.push_back({name, parameters(variables)});
  return result;
}

void PddlTask::check_domain_name(const std::vector<PddlTerm>& sections) {
  for (const PddlTerm& section : sections) {
    if (!section.begins_with(":domain") || section.list.size() != 2 || section.list[1].word == domain_)
      continue;
    error("other-domain",
          "the problem is of the domain " + quote(section.list[1].word) + ", not of " + quote(domain_),
          section.where);
  }
}

void PddlTask::read_problem(const std::vector<PddlTerm>& terms) {
  const auto* sections = definition(terms, "problem");
  if (sections == nullptr) return;
  if ((*sections)[1].list.size() > 1) network_.name = (*sections)[1].list[1].word;
  check_domain_name(*sections);
  check_sections(*sections, {":domain", ":requirements", ":objects", ":init", ":goal", ":metric", ":length"},
                 {}, diagnostics_);
  for (const PddlTerm& section : *sections) {
    if (section.begins_with(":objects")) read_constants(section);
  }
  PddlForms forms(arities_, diagnostics_);
  bool has_goal = false;
  for (const PddlTerm& section : *sections) {
    if (section.begins_with(":init")) read_initial(section);
    if (!section.begins_with(":goal")) continue;
    has_goal = true;
    if (section.list.size() != 2) {
      error("bad-goal", "a goal is one condition: (:goal (and ...))", section.where);
      continue;
    }
    const std::size_t before = diagnostics_.error_count();
    forms.check_condition(section.list[1], {});
    if (diagnostics_.error_count() == before) collect(section.list[1], {}, true, network_.goal);
  }
  if (!has_goal) error("missing-goal", "the problem has no (:goal ...)", terms[0].where);
}

void PddlTask::read_initial(const PddlTerm& section) {
  for (std::size_t i = 1; i < section.list.size(); ++i) {
    const PddlTerm& entry = section.list[i];
    if (entry.begins_with("=") && entry.list.size() == 3 && entry.list[1].is_list()) {
      read_value(entry);
      continue;
    }
    if (is_timed_literal(entry)) {
      error("unsupported", "a timed initial literal is not supported", entry.where);
      continue;
    }
    const bool negative = section.list[i].begins_with("not") && section.list[i].list.size() == 2;
    const auto fact = ground(negative ? section.list[i].list[1] : section.list[i], {});
    if (fact && !negative) network_.initial_world.set({*fact, true});
  }
  world_ = network_.initial_world;
}

std::string PddlTask::value_of(const PddlTerm& term, const Binding& binding) {
  if (!term.word.starts_with('?')) return term.word;
  const auto bound = binding.find(term.word);
  if (bound != binding.end()) return bound->second;
  error("unbound-variable", "nothing gives " + quote(term.word) + " a value", term.where);
  return {};
}

std::optional<task_network::FactId> PddlTask::ground(const PddlTerm& atom, const Binding& binding) {
  if (atom.list.empty() || atom.list.front().word.empty()) {
    error("bad-fact", "a fact is a list of a predicate and its arguments", atom.where);
    return std::nullopt;
  }
  const std::string& predicate = atom.list.front().word;
  if (!network_.facts.has_predicate(predicate)) {
    error("unknown-predicate", "no predicate " + quote(predicate), atom.where);
    return std::nullopt;
  }
  std::vector<std::string> arguments;
  for (std::size_t i = 1; i < atom.list.size(); ++i)
    arguments.push_back(value_of(atom.list[i], binding));
  const auto fact = network_.facts.intern(predicate, arguments);
  if (fact) return *fact;
  error("bad-fact", fact.error().message, atom.where);
  return std::nullopt;
}

/// Collects a conjunction of literals. An equality that does not hold is an error of the plan.
void PddlTask::collect(const PddlTerm& condition, const Binding& binding, bool positive,
                       std::vector<task_network::Literal>& literals) {
  if (condition.is_list() && condition.list.empty()) return;
  if (condition.begins_with("and") && positive) {
    for (std::size_t i = 1; i < condition.list.size(); ++i)
      collect(condition.list[i], binding, true, literals);
    return;
  }
  if (condition.begins_with("not") && condition.list.size() == 2)
    return collect(condition.list[1], binding, !positive, literals);
  if (condition.begins_with("=") && condition.list.size() == 3) {
    const bool same = value_of(condition.list[1], binding) == value_of(condition.list[2], binding);
    if (same != positive) error("false-precondition", "this does not hold", condition.where);
    return;
  }
  if (const auto fact = ground(condition, binding)) literals.push_back({*fact, positive});
}

void PddlTask::demand(Step& step, const task_network::Literal& literal) {
  auto& all = step.spec.preconditions;
  if (std::ranges::find(all, literal) == all.end()) all.push_back(literal);
}

void PddlTask::add_effect(const PddlTerm& effect, const Binding& binding, Step& step, Effects& effects) {
  if (effect.is_list() && effect.list.empty()) return;
  if (effect.begins_with("and")) {
    for (std::size_t i = 1; i < effect.list.size(); ++i)
      add_effect(effect.list[i], binding, step, effects);
    return;
  }
  if (is_numeric_effect(effect)) return;
  if (effect.begins_with("when")) return add_conditional(effect, binding, step, effects);
  if (effect.begins_with("forall")) return add_for_all(effect, binding, step, effects);
  const bool positive = !(effect.begins_with("not") && effect.list.size() == 2);
  const auto fact = ground(positive ? effect : effect.list[1], binding);
  if (fact) effects.push_back({*fact, positive});
}

/// Adds preconditions that preserve the truth of the condition: all its literals if it holds, else a false
/// one.
void PddlTask::add_conditional(const PddlTerm& effect, const Binding& binding, Step& step, Effects& effects) {
  if (effect.list.size() != 3) return error("bad-effect", "expected (when CONDITION EFFECT)", effect.where);
  std::vector<task_network::Literal> condition;
  const std::size_t before = diagnostics_.error_count();
  collect(effect.list[1], binding, true, condition);
  if (diagnostics_.error_count() > before) return;
  const auto unmet = std::ranges::find_if(
      condition, [&](const task_network::Literal& literal) { return !step.before.holds(literal); });
  if (unmet != condition.end()) return demand(step, {unmet->fact, !unmet->value});
  for (const task_network::Literal& literal : condition)
    demand(step, literal);
  add_effect(effect.list[2], binding, step, effects);
}

void PddlTask::add_for_all(const PddlTerm& effect, const Binding& binding, Step& step, Effects& effects,
                           std::size_t variable) {
  if (effect.list.size() != 3)
    return error("bad-effect", "expected (forall (VARIABLES) EFFECT)", effect.where);
  const auto variables = read_typed_list(effect.list[1].list, 0, diagnostics_);
  if (variable == variables.size()) return add_effect(effect.list[2], binding, step, effects);
  for (const std::string& object : objects_) {
    if (!network_.facts.is_a(object, variables[variable].types)) continue;
    Binding inner = binding;
    inner[variables[variable].name] = object;
    add_for_all(effect, inner, step, effects, variable + 1);
  }
}

}  // namespace segue::pddl::detail
