// SPDX-License-Identifier: Apache-2.0
#include <segue/base/names_of.hpp>
#include <segue/base/text.hpp>
#include <segue/mission/controllers.hpp>
#include <segue/model/member_check.hpp>

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace segue::mission {

namespace {

/// Checks the properties, operations and ports by which an action uses one controller.
void check_use(const ControllerUse& use, model::MemberCheck check) {
  for (const MemberValue& one : use.set)
    check.property(one.member, one.where);
  for (const MemberValue& one : use.call)
    check.call(one.member, one.value, one.where);
  for (const MemberValue& one : use.write)
    check.port(one.member, model::Direction::Input, one.where);
  for (const EndCondition& condition : use.until) {
    if (const auto* seen = std::get_if<RobotCondition>(&condition.when))
      check.condition(*seen, condition.where);
  }
  for (const OutputSource& one : use.outputs)
    check.port(one.port, model::Direction::Output, one.where);
}

/// Something that the mission observes.
struct Observed {
  std::string what;
  std::string task;
  SourcePlace where;
};

/// Calls `check` for every controller that has its task, of which there must be one.
void check_observed(const Observed& observed, const std::vector<model::Network>& controllers,
                    const model::ComponentCatalog& catalog, Diagnostics& diagnostics,
                    const std::function<void(model::MemberCheck)>& check) {
  std::vector<std::string> names;
  bool found = false;
  for (const auto& controller : controllers) {
    for (const auto& one : controller.tasks)
      names.push_back(one.id.str());
    if (controller.find_task(model::TaskId(observed.task)) == nullptr) continue;
    found = true;
    check(model::MemberCheck(observed.what, controller, catalog, diagnostics));
  }
  if (found) return;
  diagnostics.error("unknown-task",
                    observed.what + ": no controller of the robot has a task " + quote(observed.task) +
                        did_you_mean(observed.task, names),
                    observed.where);
}

void check_observed(const Mission& mission, const std::vector<model::Network>& controllers,
                    const model::ComponentCatalog& catalog, Diagnostics& diagnostics) {
  for (const ObservedFact& fact : mission.observed) {
    check_observed({"the observed fact " + quote(to_string(fact.fact)), task_of(fact.when), fact.where},
                   controllers, catalog, diagnostics,
                   [&](model::MemberCheck check) { check.condition(fact.when, fact.where); });
  }
  for (const Resource& resource : mission.resources) {
    if (!resource.observe) continue;
    check_observed({"the resource " + quote(resource.name), task_of(*resource.observe), resource.where},
                   controllers, catalog, diagnostics, [&](model::MemberCheck check) {
                     if (const auto* counts = std::get_if<SampleCounts>(&*resource.observe))
                       check.port(counts->port, model::Direction::Output, resource.where);
                     else
                       check.condition(std::get<RobotCondition>(*resource.observe), resource.where);
                   });
  }
}

void report_unknown(const Action& action, const std::string& controller,
                    const std::vector<std::string>& names, Diagnostics& diagnostics) {
  diagnostics.error("unknown-controller",
                    "action " + quote(action.name.str()) + ": the robot has no controller " +
                        quote(controller) + did_you_mean(controller, names),
                    action.where);
}

}  // namespace

std::optional<std::string> controller_name(
    std::string name, const std::function<std::optional<std::string>(const std::string& input)>& value_of) {
  for (const std::string& input : placeholders(name)) {
    const auto value = value_of(input);
    if (!value) return std::nullopt;
    name.replace(name.find("{" + input + "}"), input.size() + 2, *value);
  }
  return name;
}

bool can_mean(std::string pattern, std::string_view controller) {
  return matches_glob(*controller_name(std::move(pattern), [](const std::string&) { return "*"; }),
                      controller);
}

void check_controllers(const Mission& mission, const std::vector<model::Network>& controllers,
                       const model::ComponentCatalog& catalog, Diagnostics& diagnostics) {
  std::vector<std::string> names;
  for (const auto& controller : controllers)
    names.push_back(controller.name.str());
  for (const Action& action : mission.actions) {
    for (const std::string& controller : action.controllers.value_or(std::vector<std::string>())) {
      const auto is_meant = [&](const std::string& name) { return can_mean(controller, name); };
      if (!std::ranges::any_of(names, is_meant)) report_unknown(action, controller, names, diagnostics);
    }
    const auto* use = std::get_if<ControllerUse>(&action.run);
    if (use == nullptr) continue;
    bool found = false;
    for (const auto& controller : controllers) {
      if (!can_mean(use->controller, controller.name.str())) continue;
      found = true;
      check_use(*use, {"action " + quote(action.name.str()), controller, catalog, diagnostics});
    }
    if (!found) report_unknown(action, use->controller, names, diagnostics);
  }
  check_observed(mission, controllers, catalog, diagnostics);
}

void check_robot_units(const Mission& mission, const std::vector<model::UnitStock>& units,
                       Diagnostics& diagnostics) {
  const std::vector<std::string> names = names_of(units);
  for (const Resource& resource : mission.resources) {
    if (!resource.of_robot || std::ranges::find(names, resource.name) != names.end()) continue;
    diagnostics.error("unknown-units",
                      "resource " + quote(resource.name) + ": the robot file has no such units" +
                          (names.empty() ? ", as in `units: {" + resource.name + ": 3}`"
                                         : did_you_mean(resource.name, names)),
                      resource.where);
  }
}

}  // namespace segue::mission
