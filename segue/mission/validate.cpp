// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/checks.hpp>
#include <segue/mission/mission_io.hpp>

#include <algorithm>

namespace segue::mission {

using type::Value;

bool accepts(std::string_view type, const Value& value) {
  if (value.is_null()) return true;
  if (type == "bool") return value.is_bool();
  if (type == "int") return value.is_integer();
  if (type == "float") return value.is_number();
  if (type == "text") return value.is_string();
  if (type == "list") return value.is_list();
  if (type == "map") return value.is_map();
  return true;
}

bool connects(std::string_view from, std::string_view to) {
  return from == to || from == "any" || to == "any" || (from == "int" && to == "float");
}

Diagnostics validate(const Mission& mission) {
  return detail::validate(MissionIndex(mission));
}

namespace detail {

Diagnostics validate(const MissionIndex& index) {
  Diagnostics diagnostics;
  check_actions(index.mission(), diagnostics);
  check_facts(index.mission(), diagnostics);
  check_declared_data(index.mission(), diagnostics);
  check_resources(index.mission(), diagnostics);
  check_pools(index.mission(), diagnostics);
  check_controllers(index.mission(), diagnostics);
  check_control(index, diagnostics);
  check_data(index, diagnostics);
  if (!diagnostics.has_errors()) check_units(index, diagnostics);
  diagnostics.sort();
  return diagnostics;
}

std::string state_text(const Mission& mission, StateIndex index) {
  if (index == 0) return "the mission";
  const State& state = mission.states[index];
  return (state.parent == kNoState ? "library " : "state ") + quote(state.id.str());
}

std::string suggestion(const std::vector<Port>& ports, const std::string& name) {
  std::vector<std::string> names;
  for (const Port& port : ports)
    names.push_back(port.name);
  return did_you_mean(name, names);
}

void check_value(const Port& declared, const Value& value, const std::string& what, const SourcePlace& where,
                 const Mission& mission, Diagnostics& diagnostics) {
  const bool global =
      value.is_string() && value.as_string().starts_with('$') && !value.as_string().starts_with("$$");
  if (!global) {
    if (accepts(declared.type, value)) return;
    diagnostics.error("type-mismatch",
                      what + ": " + quote(declared.name) + " is of type " + declared.type +
                          ", but its value is " + type::describe(value),
                      where);
    return;
  }
  const std::string name = value.as_string().substr(1);
  const auto found = position(mission.globals, name);
  if (!found) {
    diagnostics.warning("unknown-global",
                        what + ": " + quote(declared.name) + " takes the global variable " + quote(name) +
                            ", which is not declared under 'globals'" + suggestion(mission.globals, name),
                        where);
  } else if (!connects(mission.globals[*found].type, declared.type)) {
    diagnostics.error("type-mismatch",
                      what + ": " + quote(declared.name) + " is of type " + declared.type +
                          ", but the global variable " + quote(name) + " of type " +
                          mission.globals[*found].type,
                      where);
  }
}

namespace {

class ActionCheck {
 public:
  ActionCheck(const Mission& mission, const Action& action, Diagnostics& diagnostics)
      : ActionCheck(mission, action, diagnostics, "action " + quote(action.name.str())) {}
  /// `action` may be what a container declares; `what` names it.
  ActionCheck(const Mission& mission, const Action& action, Diagnostics& diagnostics, std::string what)
      : mission_(mission), action_(action), diagnostics_(diagnostics), what_(std::move(what)) {}

  void run() {
    check_names();
    for (const auto* ports : {&action_.inputs, &action_.outputs}) {
      for (const Port& port : *ports)
        check_value(port, port.value, what_, port.where, mission_, diagnostics_);
    }
    if (action_.strict && action_.action_class() != ActionClass::Irreversible && action_.effects.empty()) {
      diagnostics_.warning("ignored-strict",
                           what_ + " is strict, which has no effect: it is " +
                               (action_.sensing ? "sensing" : "pure") + " and changes no facts",
                           action_.where);
    }
    if (!action_.expected_outcome.empty()) check_outcome(action_.expected_outcome);
    for (const OutcomeLikelihood& one : action_.likelihoods)
      check_outcome(one.outcome);
    if (const auto* simulated = std::get_if<Simulated>(&action_.run)) check(*simulated);
    if (const auto* decision = std::get_if<Decision>(&action_.run)) {
      for (const DecisionRule& rule : decision->rules)
        check_outcome(rule.outcome);
    }
  }

  /// The inputs that its facts and resources name.
  void check_names() {
    for (const auto* facts : {&action_.preconditions, &action_.during, &action_.effects}) {
      for (const Fact& fact : *facts)
        check_placeholders(to_string(fact), fact.where);
    }
    for (const ResourceUse& use : action_.resources) {
      check_placeholders(use.resource, use.where);
      for (const auto& [key, parameter] : use.parameters.as_map()) {
        if (const auto name = parameter_input(parameter)) check_placeholders("{" + *name + "}", use.where);
      }
    }
  }

 private:
  void check_placeholders(const std::string& text, const SourcePlace& where) {
    for (const std::string& name : placeholders(text)) {
      if (position(action_.inputs, name)) continue;
      diagnostics_.error("unknown-port",
                         what_ + ": " + quote(text) + " uses the input " + quote(name) +
                             ", which it does not have" + suggestion(action_.inputs, name),
                         where);
    }
  }

  void check_outcome(const std::string& outcome) {
    if (outcome == kAbortedName || outcome == kPreemptedName) return;
    if (std::ranges::find(action_.outcomes, outcome) != action_.outcomes.end()) return;
    diagnostics_.error("unknown-outcome",
                       what_ + " has no outcome " + quote(outcome) + did_you_mean(outcome, action_.outcomes),
                       action_.where);
  }

  void check(const Simulated& simulated) {
    for (const std::string& outcome : simulated.outcomes)
      check_outcome(outcome);
    for (const PortValue& value : simulated.outputs) {
      const auto port = position(action_.outputs, value.port);
      if (port) {
        check_value(action_.outputs[*port], value.value, what_, value.where, mission_, diagnostics_);
      } else {
        diagnostics_.error(
            "unknown-port",
            what_ + " has no output " + quote(value.port) + suggestion(action_.outputs, value.port),
            value.where);
      }
    }
    if (simulated.outcomes.empty() && action_.outcomes.empty()) {
      diagnostics_.error("unknown-outcome", what_ + " has no outcome that its simulation could end with",
                         action_.where);
    }
  }

  const Mission& mission_;
  const Action& action_;
  Diagnostics& diagnostics_;
  std::string what_;
};

}  // namespace

void check_actions(const Mission& mission, Diagnostics& diagnostics) {
  for (const Port& global : mission.globals) {
    if (accepts(global.type, global.value)) continue;
    diagnostics.error("type-mismatch",
                      "the global variable " + quote(global.name) + " is of type " + global.type +
                          ", but its value is " + type::describe(global.value),
                      global.where);
  }
  for (const Action& action : mission.actions)
    ActionCheck(mission, action, diagnostics).run();
  for (StateIndex i = 0; i < mission.states.size(); ++i) {
    if (const auto declared = declared_by(mission.states[i]))
      ActionCheck(mission, *declared, diagnostics, state_text(mission, i)).check_names();
  }
}

}  // namespace detail
}  // namespace segue::mission
