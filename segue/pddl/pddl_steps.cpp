// SPDX-License-Identifier: Apache-2.0
// Steps of a plan: PddlTask::read_plan.
#include <segue/base/text.hpp>
#include <segue/pddl/pddl_task.hpp>

#include <algorithm>

namespace segue::pddl::detail {

namespace {

/// "distance a b"
std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words)
    text += (text.empty() ? "" : " ") + word;
  return text;
}

}  // namespace

/// "(= (distance a b) 5)". Only numbers can decide durations.
void PddlTask::read_value(const PddlTerm& entry) {
  std::vector<std::string> words;
  for (const PddlTerm& word : entry.list[1].list)
    words.push_back(word.word);
  if (const auto number = number_in(entry.list[2].word)) values_[joined(words)] = *number;
}

bool PddlTask::bind(const Action& action, const PddlTerm& term, Binding& binding) {
  if (term.list.size() != action.parameters.size() + 1) {
    error("bad-step",
          "the action takes " + std::to_string(action.parameters.size()) + " arguments, not " +
              std::to_string(term.list.size() - 1),
          term.where);
    return false;
  }
  for (std::size_t i = 0; i < action.parameters.size(); ++i) {
    const PddlTerm& argument = term.list[i + 1];
    if (!network_.facts.is_a(argument.word, action.parameters[i].types)) {
      error("bad-step",
            quote(argument.word) + " is not an object of type " + listed(action.parameters[i].types),
            argument.where);
      return false;
    }
    binding[action.parameters[i].name] = argument.word;
  }
  return true;
}

void PddlTask::read_plan(const std::vector<PddlStep>& given) {
  std::vector<Step> steps;
  for (const PddlStep& each : given) {
    auto step = step_of(each, static_cast<std::uint32_t>(steps.size()));
    if (!step) continue;
    simulate(*step);
    steps.push_back(std::move(*step));
  }
  for (const task_network::Literal& literal : network_.goal) {
    if (!world_.holds(literal)) {
      error("goal-missed", "the plan does not reach the goal " + network_.facts.text(literal),
            given.empty() ? SourceLocation{} : given.back().action.where);
    }
  }
  keep_apart(steps);
  for (Step& step : steps) {
    network_.append(step.spec);
    plan_.steps.push_back(std::move(step.planned));
  }
}

std::optional<PddlTask::Step> PddlTask::step_of(const PddlStep& given, std::uint32_t number) {
  const PddlTerm& term = given.action;
  const auto found = term.list.empty() ? actions_.end() : actions_.find(term.list.front().word);
  if (found == actions_.end()) {
    error("unknown-action", "a step is a list of an action of the domain and its objects", term.where);
    return std::nullopt;
  }
  const Action& action = found->second;
  Binding binding;
  if (!bind(action, term, binding)) return std::nullopt;
  Step step;
  step.before = world_;
  step.where = term.where;
  step.planned.action = found->first;
  for (std::size_t i = 1; i < term.list.size(); ++i)
    step.planned.objects.push_back(term.list[i].word);
  step.spec.name =
      step.planned.action + (step.planned.objects.empty() ? "" : " ") + joined(step.planned.objects);
  step.spec.iteration = number;
  step.spec.duration = duration(action, binding, given);
  add_effects(action, binding, step);
  add_conditions(action, binding, step);
  return step;
}

/// Effects at the start that are undone at the end are none of the whole step.
void PddlTask::add_effects(const Action& action, const Binding& binding, Step& step) {
  Effects at_start;
  add_effect(action.effect.at_start, binding, step, at_start);
  add_effect(action.effect.at_end, binding, step, step.spec.effects);
  const Effects at_end = step.spec.effects;
  for (const task_network::Literal& literal : at_start) {
    const auto later = std::ranges::find(at_end, literal.fact, &task_network::Literal::fact);
    if (later == at_end.end())
      step.spec.effects.push_back(literal);
    else if (later->value != literal.value)
      step.planned.meanwhile.push_back(literal.fact);
  }
}

/// Conditions over all and at the end that effects at the start make true are none of the whole step.
void PddlTask::add_conditions(const Action& action, const Binding& binding, Step& step) {
  std::vector<task_network::Literal> all;
  collect(action.condition.at_start, binding, true, all);
  Effects at_start;
  add_effect(action.effect.at_start, binding, step, at_start);
  std::vector<task_network::Literal> later;
  collect(action.condition.at_end, binding, true, later);
  collect(action.condition.over_all, binding, true, step.planned.during);
  later.insert(later.end(), step.planned.during.begin(), step.planned.during.end());
  for (const task_network::Literal& literal : later) {
    // Of contradicting effects, the positive one counts.
    const bool is_made = std::ranges::find(at_start, literal) != at_start.end();
    const bool is_undone =
        std::ranges::find(at_start, task_network::Literal{literal.fact, !literal.value}) != at_start.end();
    if (is_undone && !(is_made && literal.value))
      error("false-precondition", "the step itself undoes " + network_.facts.text(literal), step.where);
    else if (!is_made)
      all.push_back(literal);
  }
  for (const task_network::Literal& literal : all)
    demand(step, literal);
}

void PddlTask::simulate(const Step& step) {
  for (const task_network::Literal& literal : step.spec.preconditions) {
    if (!world_.holds(literal))
      error("false-precondition", network_.facts.text(literal) + " does not hold before this step",
            step.where);
  }
  for (const bool value : {false, true}) {
    for (const task_network::Literal& literal : step.spec.effects) {
      if (literal.value == value) world_.set(literal);
    }
  }
}

std::optional<double> PddlTask::value(const PddlTerm& function, const Binding& binding) {
  std::vector<std::string> words;
  for (const PddlTerm& word : function.list)
    words.push_back(value_of(word, binding));
  const std::string name = joined(words);
  const auto found = values_.find(name);
  if (changed_functions_.contains(words.empty() ? "" : words.front())) {
    error("unsupported",
          "a duration by a function that actions change, " + quote(words.front()) + ", is not supported",
          function.where);
    return std::nullopt;
  }
  if (found != values_.end()) return found->second;
  error("no-value", "the problem gives (" + name + ") no value", function.where);
  return std::nullopt;
}

/// As the plan says, or else as the domain does where it leaves no choice. Planners round to milliseconds.
Duration PddlTask::duration(const Action& action, const Binding& binding, const PddlStep& given) {
  if (!action.duration) return std::chrono::seconds(1);
  const auto allowed = duration_of(
      *action.duration, [&](const PddlTerm& function) { return value(function, binding); }, diagnostics_);
  if (!allowed) return {};
  if (!given.duration && allowed->least != allowed->most) {
    error("bad-duration", "the plan does not say how long this step takes, such as [1.5]",
          given.action.where);
    return {};
  }
  constexpr double kMost = 1e9;
  const double seconds = given.duration.value_or(allowed->least);
  const double rounding = 0.001 + seconds * 1e-6;
  if (seconds + rounding < allowed->least || seconds - rounding > allowed->most || seconds > kMost) {
    error("bad-duration", "the action does not take " + std::to_string(seconds) + " s", given.action.where);
    return {};
  }
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
}

/// Between start and end of a step, a fact is not what it is before and afterwards, so nobody else may touch
/// it.
void PddlTask::keep_apart(std::vector<Step>& steps) {
  std::set<task_network::FactId> changing;
  for (const Step& step : steps)
    changing.insert(step.planned.meanwhile.begin(), step.planned.meanwhile.end());
  for (Step& step : steps) {
    std::set<task_network::FactId> touched(step.planned.meanwhile.begin(), step.planned.meanwhile.end());
    for (const auto* literals : {&step.spec.preconditions, &step.spec.effects}) {
      for (const task_network::Literal& literal : *literals)
        touched.insert(literal.fact);
    }
    for (const task_network::FactId fact : touched) {
      if (!changing.contains(fact)) continue;
      step.spec.claims.push_back(
          {.resource = network_.resources.intern("task:" + network_.facts.text(fact))});
    }
  }
}

}  // namespace segue::pddl::detail
