// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/action_runner.hpp>
#include <segue/robot/served_robot.hpp>
#include <segue/session/pause_control.hpp>

#include <cstdint>
#include <functional>
#include <mutex>
#include <set>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>

#include "command.hpp"

namespace segue::cli {

/// Lets other programs see and steer a mission that commands a robot, through that robot: `segue mission
/// status`, `pause`, `resume` and `stop`; and the robot record it in its journal.
class MissionRemote {
 public:
  /// What the mission will do (draw::shown_plan), made where somebody wants to see it.
  using Plan = std::function<type::Value()>;

  /// Starts a thread that reports and listens until this is destroyed. All must outlive it. `stop` is
  /// requested when the mission shall stop.
  MissionRemote(robot::ServedRobot& robot, std::string mission, Plan plan, session::PauseControl& pause,
                std::stop_source stop);
  MissionRemote(const MissionRemote&) = delete;
  MissionRemote& operator=(const MissionRemote&) = delete;

  /// Of the run. From any thread.
  void observe(const mission::ActionEvent& event);
  /// The run has ended, `error` says why it aborted. What it did is in the robot's journal once this is
  /// destroyed, as far as the robot could be reached.
  void ended(std::string_view outcome, std::string_view error);

 private:
  void work(const std::stop_token& end);
  void heed(const std::string& what);
  void report(type::Value& reported);
  [[nodiscard]] type::Value doing() const;

  robot::ServedRobot& robot_;
  const std::string mission_;
  const Plan plan_;
  session::PauseControl& pause_;
  std::stop_source stop_;
  mutable std::mutex mutex_;                         ///< protects the next two
  std::multiset<std::string, std::less<>> running_;  ///< paths of actions
  std::uint64_t ended_ = 0;                          ///< actions
  bool shall_show_plan_ = false;                     ///< for the thread only
  std::jthread thread_;
};

/// `segue mission status`, `pause`, `resume` and `stop`.
void add_mission_remote(Verb& mission, Context& context);

}  // namespace segue::cli
