// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/checks.hpp>
#include <segue/mission/controllers.hpp>
#include <segue/mission/world_values.hpp>

#include <algorithm>
#include <utility>

namespace segue::mission::detail {

using type::Value;

namespace {

void check_input(const Action& action, const std::string& name, const SourcePlace& where,
                 Diagnostics& diagnostics) {
  if (position(action.inputs, name) || placeholder_field(name)) return;
  diagnostics.error("unknown-port",
                    "action " + quote(action.name.str()) + ": it uses the input " + quote(name) +
                        ", which it does not have" + suggestion(action.inputs, name),
                    where);
}

class ControllerCheck {
 public:
  ControllerCheck(const Action& action, const ControllerUse& use, Diagnostics& diagnostics)
      : action_(action), use_(use), diagnostics_(diagnostics), what_("action " + quote(action.name.str())) {}

  void run() {
    for (const std::string& name : placeholders(use_.controller))
      check_input(action_, name, action_.where, diagnostics_);
    for (const auto* values : {&use_.set, &use_.call, &use_.write}) {
      for (const MemberValue& one : *values)
        detail::check_inputs(action_, one.value, one.where, diagnostics_);
    }
    for (const EndCondition& condition : use_.until)
      check_outcome(condition);
    for (const OutputSource& one : use_.outputs)
      check_output(one);
    if (action_.pure || action_.sensing) {
      error("bad-class", "a controller moves the robot, so it is neither pure nor sensing", action_.where);
    }
  }

 private:
  void error(std::string code, const std::string& message, const SourcePlace& where) {
    diagnostics_.error(std::move(code), what_ + ": " + message, where);
  }

  void check_outcome(const EndCondition& condition) {
    const auto& own = action_.outcomes;
    const bool known = condition.outcome.empty() ? !own.empty()
                                                 : condition.outcome == kAbortedName ||
                                                       std::ranges::find(own, condition.outcome) != own.end();
    if (known) return;
    error("unknown-outcome",
          "it has no outcome " + quote(condition.outcome) + did_you_mean(condition.outcome, own),
          condition.where);
  }

  void check_output(const OutputSource& one) {
    if (!position(action_.outputs, one.output)) {
      error("unknown-port", "it has no output " + quote(one.output) + suggestion(action_.outputs, one.output),
            one.where);
    }
  }

  const Action& action_;
  const ControllerUse& use_;
  Diagnostics& diagnostics_;
  const std::string what_;
};

}  // namespace

void check_inputs(const Action& action, const Value& value, const SourcePlace& where,
                  Diagnostics& diagnostics) {
  if (const auto name = parameter_input(value)) return check_input(action, *name, where, diagnostics);
  if (value.is_list()) {
    for (const Value& item : value.as_list())
      check_inputs(action, item, where, diagnostics);
  } else if (value.is_map()) {
    for (const auto& [key, item] : value.as_map())
      check_inputs(action, item, where, diagnostics);
  }
}

namespace {

/// Checks that an action that uses a robot may do so: it is a script that is not pure.
void check_script(const Action& action, Diagnostics& diagnostics) {
  const auto error = [&](std::string code, const std::string& message) {
    diagnostics.error(std::move(code), "action " + quote(action.name.str()) + ": " + message, action.where);
  };
  for (const std::string& controller : *action.controllers) {
    for (const std::string& name : placeholders(controller))
      check_input(action, name, action.where, diagnostics);
  }
  if (!std::holds_alternative<Script>(action.run))
    error("bad-class", "'controllers' is for actions with a script; a controller is named under 'run'");
  if (action.pure)
    error("bad-class", "a script that uses a robot is not pure; one that only looks at it is 'sensing'");
  if (action.sensing && !action.controllers->empty())
    error("bad-class", "a controller moves the robot, so what requests it is not 'sensing'");
}

}  // namespace

void check_controllers(const Mission& mission, Diagnostics& diagnostics) {
  for (const Action& action : mission.actions) {
    if (action.controllers) check_script(action, diagnostics);
    if (const auto* use = std::get_if<ControllerUse>(&action.run))
      ControllerCheck(action, *use, diagnostics).run();
  }
}

}  // namespace segue::mission::detail
