// SPDX-License-Identifier: Apache-2.0
#include <segue/base/life_cycle.hpp>
#include <segue/base/text.hpp>
#include <segue/mission/controllers.hpp>

#include <algorithm>
#include <utility>

namespace segue::mission {

using model::ComponentModel;
using type::Value;

namespace {

template <class Items>
std::vector<std::string> names_of(const Items& items) {
  std::vector<std::string> names;
  for (const auto& item : items)
    names.push_back(item.name);
  return names;
}

/// What an action or an observed fact (`what`) asks of one controller.
class MemberCheck {
 public:
  MemberCheck(std::string what, const model::Network& controller, const model::ComponentCatalog& catalog,
              Diagnostics& diagnostics)
      : what_(std::move(what)), controller_(controller), catalog_(catalog), diagnostics_(diagnostics) {}

  void run(const ControllerUse& use) {
    for (const MemberValue& one : use.set)
      check_property(one);
    for (const MemberValue& one : use.call) {
      if (const auto* operation = find_operation(one.member, one.where)) check_arguments(*operation, one);
    }
    for (const MemberValue& one : use.write)
      check_port(one.member, model::Direction::Input, one.where);
    for (const EndCondition& condition : use.until) {
      if (const auto* seen = std::get_if<RobotCondition>(&condition.when)) run(*seen, condition.where);
    }
    for (const OutputSource& one : use.outputs)
      check_port(one.port, model::Direction::Output, one.where);
  }

  void run(const RobotCondition& condition, const SourcePlace& where) {
    std::visit([&](const auto& when) { check(when, where); }, condition);
  }

 private:
  void error(std::string code, const std::string& message, const SourcePlace& where) {
    diagnostics_.error(std::move(code),
                       what_ + ": in controller " + quote(controller_.name.str()) + ", " + message, where);
  }

  /// The component model of a task; nullptr, with an error, if there is no such task, and without one if its
  /// component is not known.
  const ComponentModel* component_of(const std::string& task, const SourcePlace& where) {
    const auto* found = controller_.find_task(model::TaskId(task));
    if (found != nullptr) return catalog_.find(found->component);
    std::vector<std::string> names;
    for (const auto& one : controller_.tasks)
      names.push_back(one.id.str());
    error("unknown-task", "there is no task " + quote(task) + did_you_mean(task, names), where);
    return nullptr;
  }

  void no_member(std::string_view kind, const Member& member, const std::vector<std::string>& names,
                 const SourcePlace& where) {
    error("unknown-" + std::string(kind.substr(kind.rfind(' ') + 1)),
          "task " + quote(member.task) + " has no " + std::string(kind) + " " + quote(member.name) +
              did_you_mean(member.name, names),
          where);
  }

  void check_property(const MemberValue& one) {
    const auto* component = component_of(one.member.task, one.where);
    const std::string name = one.member.name.substr(0, one.member.name.find('.'));
    if (component == nullptr || component->find_property(name) != nullptr) return;
    no_member("property", one.member, names_of(component->properties), one.where);
  }

  const model::OperationModel* find_operation(const Member& member, const SourcePlace& where) {
    const auto* component = component_of(member.task, where);
    if (component == nullptr) return nullptr;
    const auto found = std::ranges::find(component->operations, member.name, &model::OperationModel::name);
    if (found != component->operations.end()) return &*found;
    no_member("operation", member, names_of(component->operations), where);
    return nullptr;
  }

  /// An input as the value as a whole may be anything.
  void check_arguments(const model::OperationModel& operation, const MemberValue& one) {
    const bool none = one.value.is_null();
    if (!none && !one.value.is_map()) return;
    const auto names = names_of(operation.arguments);
    for (const std::string& name : names) {
      if (!none && one.value.find(name) != nullptr) continue;
      error("missing-argument", to_string(one.member) + " needs the argument " + quote(name), one.where);
    }
    if (none) return;
    for (const auto& [name, value] : one.value.as_map()) {
      if (std::ranges::find(names, name) != names.end()) continue;
      error("unknown-argument",
            to_string(one.member) + " has no argument " + quote(name) + did_you_mean(name, names), one.where);
    }
  }

  void check_port(const Member& port, model::Direction direction, const SourcePlace& where) {
    const auto* component = component_of(port.task, where);
    if (component == nullptr || component->find_port(port.name, direction) != nullptr) return;
    if (component->incomplete) return;
    std::vector<std::string> names;
    for (const auto& one : component->ports) {
      if (one.direction == direction) names.push_back(one.name);
    }
    no_member(direction == model::Direction::Output ? "output port" : "input port", port, names, where);
  }

  void check(const SampleShows& when, const SourcePlace& where) {
    check_port(when.port, model::Direction::Output, where);
  }
  void check(const OperationAnswers& when, const SourcePlace& where) {
    const auto* operation = find_operation(when.operation, where);
    if (operation == nullptr || operation->arguments.empty()) return;
    error("missing-argument", to_string(when.operation) + " has arguments, so a condition cannot ask it",
          where);
  }
  void check(const TaskReaches& when, const SourcePlace& where) {
    const auto* component = component_of(when.task, where);
    if (component == nullptr || component->incomplete) return;
    std::vector<std::string> names(kTaskStateNames.begin(), kTaskStateNames.end());
    for (const auto* states : {&component->nominal_states, &component->error_states})
      names.insert(names.end(), states->begin(), states->end());
    if (std::ranges::find(names, when.state) != names.end()) return;
    no_member("state", {when.task, when.state}, names, where);
  }

  const std::string what_;
  const model::Network& controller_;
  const model::ComponentCatalog& catalog_;
  Diagnostics& diagnostics_;
};

std::string task_of(const RobotCondition& condition) {
  if (const auto* reaches = std::get_if<TaskReaches>(&condition)) return reaches->task;
  if (const auto* shows = std::get_if<SampleShows>(&condition)) return shows->port.task;
  return std::get<OperationAnswers>(condition).operation.task;
}

/// In every controller that has its task, of which there must be one.
void check_observed(const ObservedFact& observed, const std::vector<model::Network>& controllers,
                    const model::ComponentCatalog& catalog, Diagnostics& diagnostics) {
  const std::string what = "the observed fact " + quote(to_string(observed.fact));
  const std::string task = task_of(observed.when);
  std::vector<std::string> names;
  bool found = false;
  for (const auto& controller : controllers) {
    for (const auto& one : controller.tasks)
      names.push_back(one.id.str());
    if (controller.find_task(model::TaskId(task)) == nullptr) continue;
    found = true;
    MemberCheck(what, controller, catalog, diagnostics).run(observed.when, observed.where);
  }
  if (found) return;
  diagnostics.error(
      "unknown-task",
      what + ": no controller of the robot has a task " + quote(task) + did_you_mean(task, names),
      observed.where);
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
      MemberCheck("action " + quote(action.name.str()), controller, catalog, diagnostics).run(*use);
    }
    if (!found) report_unknown(action, use->controller, names, diagnostics);
  }
  for (const ObservedFact& observed : mission.observed)
    check_observed(observed, controllers, catalog, diagnostics);
}

}  // namespace segue::mission
