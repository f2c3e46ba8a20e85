// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/mutex.hpp>
#include <segue/mission/action_runner.hpp>
#include <segue/mission/commanded_robot.hpp>
#include <segue/type/value.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <string_view>
#include <utility>

namespace segue::remote_robot {

/// The events of a mission, for the journal of the robot that it commands: they wait here until the robot has
/// taken them (ServedRobot::report). Thread safe; nothing blocks.
class MissionRecord {
 public:
  /// How many entries wait and travel at once.
  struct Limits {
    std::size_t waiting = 4000;  ///< entries; beyond that the oldest are dropped, and counted
    std::size_t at_once = 500;   ///< entries of one report
  };
  explicit MissionRecord(Limits limits) : limits_(limits) {}
  MissionRecord() : MissionRecord(Limits{}) {}

  /// Events that follow belong to that mission. Events before the first mission began are not recorded.
  /// `mode`: how it runs, "sequential" or "concurrent"; empty: that is not recorded.
  void began(std::string_view mission, std::string_view mode = {});
  /// An action began or ended. Where the mission itself is the action, it is told by began() and ended().
  void observe(const mission::StateEvent& event);
  /// An action asks for a controller, or for its end where `controller` is empty, which is not recorded.
  void asked(const mission::ControllerRequest::Cause& cause);
  /// The mission ended; `error` says why it aborted.
  void ended(std::string_view outcome, std::string_view error);

  /// The mission's name; empty: none has begun.
  [[nodiscard]] std::string mission() const;
  [[nodiscard]] bool has_waiting() const;
  /// The events that wait, as "happened" of control::RobotService::report(), with the number of the last one;
  /// 0: there are none.
  [[nodiscard]] std::pair<type::Value, std::uint64_t> waiting() const;
  /// The robot has taken what waited up to that number.
  void taken(std::uint64_t number);

 private:
  struct Entry {
    std::uint64_t number = 0;
    std::chrono::system_clock::time_point time{};
    std::string_view kind{};  ///< of journal::MissionEntry: "began", "asked", "ended"
    std::string action{};     ///< empty: the mission itself
    std::uint64_t iteration = 0;
    std::string controller{};
    std::string outcome{};
    std::string error{};
    Duration duration{0};
    std::string mode{};  ///< of the mission itself
  };
  static type::Value to_value(const Entry& entry);
  void add(Entry entry) SEGUE_REQUIRES(mutex_);
  [[nodiscard]] Duration since_begin_of(const std::string& action, std::uint64_t iteration)
      SEGUE_REQUIRES(mutex_);

  const Limits limits_;
  mutable Mutex mutex_;  ///< protects all below
  std::string mission_ SEGUE_GUARDED_BY(mutex_);
  std::uint64_t last_number_ SEGUE_GUARDED_BY(mutex_) = 0;
  std::uint64_t lost_ SEGUE_GUARDED_BY(mutex_) = 0;
  std::deque<Entry> waiting_ SEGUE_GUARDED_BY(mutex_);
  /// The begins of actions that have not ended.
  std::map<std::pair<std::string, std::uint64_t>, TimePoint> begins_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::remote_robot
