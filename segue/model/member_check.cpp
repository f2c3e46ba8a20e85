// SPDX-License-Identifier: Apache-2.0
#include <segue/model/member_check.hpp>

#include <segue/base/life_cycle.hpp>
#include <segue/base/names_of.hpp>
#include <segue/base/text.hpp>
#include <segue/model/argument_names.hpp>

#include <algorithm>
#include <utility>

namespace segue::model {

void MemberCheck::error(std::string code, const std::string& message, const SourceLocation& where) {
  diagnostics_.error(std::move(code),
                     what_ + ": in controller " + quote(controller_.name.str()) + ", " + message, where);
}

const ComponentModel* MemberCheck::component_of(const std::string& task, const SourceLocation& where) {
  const auto* found = controller_.find_task(TaskId(task));
  if (found != nullptr) return catalog_.find(found->component);
  std::vector<std::string> names;
  for (const auto& one : controller_.tasks)
    names.push_back(one.id.str());
  error("unknown-task", "there is no task " + quote(task) + did_you_mean(task, names), where);
  return nullptr;
}

void MemberCheck::no_member(std::string_view kind, const Member& member,
                            const std::vector<std::string>& names, const SourceLocation& where) {
  error("unknown-" + std::string(kind.substr(kind.rfind(' ') + 1)),
        "task " + quote(member.task) + " has no " + std::string(kind) + " " + quote(member.name) +
            did_you_mean(member.name, names),
        where);
}

void MemberCheck::property(const Member& member, const SourceLocation& where) {
  const auto* component = component_of(member.task, where);
  const std::string name = member.name.substr(0, member.name.find('.'));
  if (component == nullptr || component->find_property(name) != nullptr) return;
  no_member("property", member, names_of(component->properties), where);
}

const OperationModel* MemberCheck::find_operation(const Member& member, const SourceLocation& where) {
  const auto* component = component_of(member.task, where);
  if (component == nullptr) return nullptr;
  if (const auto* found = component->find_operation(member.name)) return found;
  no_member("operation", member, names_of(component->operations), where);
  return nullptr;
}

void MemberCheck::call(const Member& member, const type::Value& arguments, const SourceLocation& where) {
  const auto* operation = find_operation(member, where);
  if (operation == nullptr || !(arguments.is_null() || arguments.is_map())) return;
  for (const ArgumentProblem& problem : check_argument_names(*operation, arguments))
    error(problem.code, to_string(member) + ' ' + problem.text, where);
}

void MemberCheck::port(const Member& port, Direction direction, const SourceLocation& where) {
  const auto* component = component_of(port.task, where);
  if (component == nullptr || component->find_port(port.name, direction) != nullptr) return;
  if (component->incomplete) return;
  std::vector<std::string> names;
  for (const auto& one : component->ports) {
    if (one.direction == direction) names.push_back(one.name);
  }
  no_member(direction == Direction::Output ? "output port" : "input port", port, names, where);
}

void MemberCheck::condition(const RobotCondition& condition, const SourceLocation& where) {
  std::visit([&](const auto& when) { check(when, where); }, condition);
}

void MemberCheck::check(const SampleShows& when, const SourceLocation& where) {
  port(when.port, Direction::Output, where);
}

void MemberCheck::check(const OperationAnswers& when, const SourceLocation& where) {
  const auto* operation = find_operation(when.operation, where);
  if (operation == nullptr || operation->arguments.empty()) return;
  error("missing-argument", to_string(when.operation) + " has arguments, so a condition cannot ask it",
        where);
}

void MemberCheck::check(const TaskReaches& when, const SourceLocation& where) {
  const auto* component = component_of(when.task, where);
  if (component == nullptr || component->incomplete) return;
  std::vector<std::string> names(kTaskStateNames.begin(), kTaskStateNames.end());
  for (const auto* states : {&component->nominal_states, &component->error_states})
    names.insert(names.end(), states->begin(), states->end());
  if (std::ranges::find(names, when.state) != names.end()) return;
  no_member("state", {when.task, when.state}, names, where);
}

}  // namespace segue::model
