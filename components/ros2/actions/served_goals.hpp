// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "action_messages.hpp"

#include <segue/base/clock.hpp>
#include <segue/type/value.hpp>

#include <cstddef>
#include <cstdint>
#include <list>
#include <vector>

namespace ros2 {

/// A goal that a server has accepted.
struct ServedGoal {
  GoalId id{};
  std::int64_t stamp = 0;            ///< when it was accepted: nanoseconds since 1970
  std::vector<std::byte> message{};  ///< of a goal that waits
  GoalState state = GoalState::Accepted;
  std::vector<std::byte> response{};  ///< to who asks for its result, once it has ended
  segue::TimePoint ended_at{};
};

/// The goals of a server: one is out at most, one waits at most, and those that have ended stay as long as
/// their results are kept. What requests mean for them is what rcl_action takes them for. One thread.
class ServedGoals {
 public:
  /// Results that are kept at most.
  static constexpr std::size_t kMostEnded = 100;

  /// nullptr: it is not known, or not any more.
  ServedGoal* find(const GoalId& id);
  /// The one that is out: executing or canceling.
  ServedGoal* out();
  /// The accepted one that is not out yet.
  ServedGoal* waiting();
  /// Accepts one. Requires that there is none of this id.
  ServedGoal& add(const GoalId& id, std::int64_t stamp);

  /// The goals that a request to cancel, {goal_info: {goal_id, stamp}}, is about, and how it is answered if
  /// any of them is canceled, or if there are none.
  struct ToCancel {
    CancelCode code = CancelCode::Agrees;
    std::vector<ServedGoal*> goals;
  };
  ToCancel meant_by(const segue::type::Value& request);

  /// Forgets results that have been kept for so long, and the oldest ones where there are too many.
  void forget_results(segue::TimePoint now, segue::Duration keep);
  /// When the next one is to be forgotten; TimePoint::max() where there is none.
  [[nodiscard]] segue::TimePoint next_to_forget(segue::Duration keep) const;

  /// action_msgs/msg/GoalStatusArray.
  [[nodiscard]] segue::type::Value status() const;
  /// action_msgs/msg/GoalInfo.
  static segue::type::Value info_of(const ServedGoal& goal);

 private:
  std::list<ServedGoal> goals_;  ///< in the order in which they were accepted
};

}  // namespace ros2
