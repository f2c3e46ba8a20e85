// SPDX-License-Identifier: Apache-2.0
#include "served_goals.hpp"

#include <algorithm>
#include <limits>

namespace ros2 {
namespace {

using segue::type::Value;

constexpr std::int64_t kSecond = 1'000'000'000;

/// Only goals that are not being canceled already can be (rcl_action_goal_handle_is_cancelable).
bool is_cancelable(const ServedGoal& goal) {
  return goal.state == GoalState::Accepted || goal.state == GoalState::Executing;
}

}  // namespace

ServedGoal* ServedGoals::find(const GoalId& id) {
  const auto found = std::ranges::find(goals_, id, &ServedGoal::id);
  return found == goals_.end() ? nullptr : &*found;
}

ServedGoal* ServedGoals::out() {
  const auto found = std::ranges::find_if(goals_, [](const ServedGoal& goal) {
    return goal.state == GoalState::Executing || goal.state == GoalState::Canceling;
  });
  return found == goals_.end() ? nullptr : &*found;
}

ServedGoal* ServedGoals::waiting() {
  const auto found = std::ranges::find(goals_, GoalState::Accepted, &ServedGoal::state);
  return found == goals_.end() ? nullptr : &*found;
}

ServedGoal& ServedGoals::add(const GoalId& id, std::int64_t stamp) {
  return goals_.emplace_back(ServedGoal{.id = id, .stamp = stamp});
}

ServedGoals::ToCancel ServedGoals::meant_by(const Value& request) {
  const Value& info = *request.find("goal_info");
  const GoalId id = goal_id_of(info);
  const Value& time = *info.find("stamp");
  std::int64_t stamp = time.find("sec")->as_int() * kSecond + time.find("nanosec")->as_int();
  const bool names_a_goal = id != GoalId{};
  if (names_a_goal && stamp == 0) {
    ServedGoal* goal = find(id);
    if (goal == nullptr) return {CancelCode::UnknownGoal, {}};
    if (!is_cancelable(*goal)) return {CancelCode::HasEnded, {}};
    return {CancelCode::Agrees, {goal}};
  }
  // Neither: all goals. A time: those that were accepted until then, and the one that is named.
  if (stamp == 0) stamp = std::numeric_limits<std::int64_t>::max();
  ToCancel meant;
  for (ServedGoal& goal : goals_) {
    if (is_cancelable(goal) && (goal.stamp <= stamp || goal.id == id)) meant.goals.push_back(&goal);
  }
  return meant;
}

void ServedGoals::forget_results(segue::TimePoint now, segue::Duration keep) {
  std::erase_if(
      goals_, [&](const ServedGoal& goal) { return !is_active(goal.state) && now - goal.ended_at >= keep; });
  const auto has_ended = [](const ServedGoal& goal) { return !is_active(goal.state); };
  for (auto ended = std::ranges::count_if(goals_, has_ended); ended > static_cast<std::ptrdiff_t>(kMostEnded);
       --ended)
    goals_.erase(std::ranges::find_if(goals_, has_ended));
}

segue::TimePoint ServedGoals::next_to_forget(segue::Duration keep) const {
  auto next = segue::TimePoint::max();
  for (const ServedGoal& goal : goals_) {
    if (!is_active(goal.state) && keep < segue::TimePoint::max() - goal.ended_at)
      next = std::min(next, goal.ended_at + keep);
  }
  return next;
}

Value ServedGoals::info_of(const ServedGoal& goal) {
  Value info = goal_id_value(goal.id);
  info.as_map().append("stamp",
                       Value::map({{"sec", goal.stamp / kSecond}, {"nanosec", goal.stamp % kSecond}}));
  return info;
}

Value ServedGoals::status() const {
  Value::List all;
  for (const ServedGoal& goal : goals_)
    all.push_back(Value::map({{"goal_info", info_of(goal)}, {"status", static_cast<int>(goal.state)}}));
  return Value::map({{"status_list", Value(std::move(all))}});
}

}  // namespace ros2
