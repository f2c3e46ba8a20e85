// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/type/value.hpp>
#include <segue/web/command.hpp>
#include <segue/web/robot_link.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace segue::web {

/// Where ROS 2 is looked at, as the properties of tasks name it.
struct Ros2Place {
  std::int64_t domain = -1;  ///< -1: as the environment of the studio says
  std::string discovery;     ///< localhost, subnet or off; empty: as the environment says
  friend bool operator==(const Ros2Place&, const Ros2Place&) = default;
};

/// Looks at the nodes of ROS 2 that run, from this computer: {"domain" (the number), "nodes", "topics"}, as
/// `segue ros2 describe --all` has them, but for command lines; each node with its "text" as a task. Called
/// by one thread at a time; blocks until `deadline` at most.
using LookAtRos2 = std::function<Result<type::Value>(const Ros2Place& place, TimePoint deadline)>;

/// Looks at ROS 2 for pages, one look at a time: who asks meanwhile gets its result, too. All functions may
/// be called from any thread.
class Ros2Looks {
 public:
  using Answer = std::function<void(const Result<type::Value>&)>;

  Ros2Looks(RobotLink& link, LookAtRos2 look) : link_(link), look_(std::move(look)) {}

  /// domain, discovery: a place of the robot's tasks (none: the first one, or where no task is of ROS 2, the
  /// environment's) -> what LookAtRos2 answers, with "place", "places" (both as {"domain", "discovery"}) and
  /// "tasks", by id: {"domain", "discovery", "name", "node", "namespace"} of those that are of ROS 2, as far
  /// as they have such properties. Calls `answer` once, at the end of the look, which another thread may
  /// make; where none is in progress, blocks for it. Unsupported where this studio does not look; Unavailable
  /// while another place is looked at; NotFound where no task is in that place.
  void begin(const Command& command, Answer answer);

 private:
  using Asked = std::optional<Ros2Place>;

  /// Whether the caller is to look; else it has been answered, or will be.
  bool take_turn(const Asked& asked, Answer answer);
  Result<type::Value> look(const Asked& asked);

  RobotLink& link_;
  const LookAtRos2 look_;
  Mutex mutex_;                                           ///< protects all below
  std::vector<Answer> waiting_ SEGUE_GUARDED_BY(mutex_);  ///< not empty: a look is in progress
  Asked asked_ SEGUE_GUARDED_BY(mutex_);                  ///< for that look
};

}  // namespace segue::web
