// SPDX-License-Identifier: Apache-2.0
#include <segue/model/transition.hpp>

#include <segue/base/text.hpp>

#include <algorithm>
#include <numeric>

namespace segue::model {
namespace {

std::string subject(const TaskAction& action) {
  return action.task.str();
}
std::string subject(const ConnectionAction& action) {
  return to_string(action.connection);
}
std::string subject(const DeploymentAction& action) {
  return to_string(action.deployment.key());
}
std::string subject(const ConfigAction& action) {
  return action.definition.id.str();
}
std::string subject(const CallAction& action) {
  return action.task.str() + "." + action.operation;
}
std::string subject(const HandOverAction& action) {
  return action.from.str() + " -> " + action.to.str();
}

}  // namespace

bool operator==(const Transition& a, const Transition& b) {
  return a.from == b.from && a.to == b.to && a.order == b.order && a.actions == b.actions &&
         a.removes == b.removes && a.redefines == b.redefines;
}

const TaskId* Action::task() const {
  if (const auto* action = std::get_if<TaskAction>(&what)) return &action->task;
  if (const auto* action = std::get_if<ConfigAction>(&what)) return &action->definition.id;
  if (const auto* action = std::get_if<CallAction>(&what)) return &action->task;
  if (const auto* action = std::get_if<HandOverAction>(&what)) return &action->to;
  return nullptr;
}

std::string Action::label() const {
  return std::string(to_string(kind)) + " " +
         std::visit([](const auto& action) { return subject(action); }, what);
}

int ActionCounts::state_changes() const {
  return of(ActionKind::Recover) + of(ActionKind::Stop) + of(ActionKind::Cleanup) +
         of(ActionKind::Configure) + of(ActionKind::Start);
}

int ActionCounts::total() const {
  return std::accumulate(by_kind.begin(), by_kind.end(), 0);
}

ActionCounts Transition::counts() const {
  ActionCounts counts;
  for (const Action& action : actions)
    ++counts.by_kind.at(static_cast<std::size_t>(action.kind));
  return counts;
}

Result<Order> order_named(std::string_view name) {
  if (name.empty()) {
    return Order::Seamless;
  }
  const auto found = std::ranges::find(kOrderNames, name);
  if (found == kOrderNames.end()) {
    return fail(ErrorCode::InvalidArgument,
                "no order " + quote(std::string(name)) + "; use 'paper' or 'seamless'");
  }
  return static_cast<Order>(found - kOrderNames.begin());
}

}  // namespace segue::model
