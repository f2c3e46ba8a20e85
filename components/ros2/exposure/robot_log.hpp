// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "rosout.hpp"
#include "shown_nodes.hpp"

#include <segue/control/robot_service.hpp>

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>

namespace ros2 {

/// Has what a robot logs on /rosout, in a thread of its own: its events, and the lines of its tasks. The
/// robot is asked only while somebody reads the topic, since each task costs it a question.
class RobotLog {
 public:
  /// `own_node` is the one whose lines the robot's events are; `nodes` is asked for in the thread.
  RobotLog(std::shared_ptr<segue::control::RobotService> robot, std::shared_ptr<Rosout> rosout,
           std::string own_node, std::function<ShownNodes()> nodes);

 private:
  /// Up to which line of which process a task's have been published.
  struct Position {
    std::int64_t pid = 0;
    std::uint64_t number = 0;
  };
  void run(const std::stop_token& stop);
  void publish_all(const std::stop_token& stop);
  void publish_events(const std::stop_token& stop);
  void publish_lines(const std::string& task, const std::string& node, const std::stop_token& stop);
  void publish(const Rosout::Line& line, const std::stop_token& stop);

  const std::shared_ptr<segue::control::RobotService> robot_;
  const std::shared_ptr<Rosout> rosout_;
  const std::string own_node_;
  const std::function<ShownNodes()> nodes_;
  std::chrono::system_clock::time_point since_{};  ///< older lines are not published
  std::uint64_t last_event_ = 0;
  std::map<std::string, Position> last_;  ///< by task
  std::size_t spaced_ = 0;                ///< lines of this look that others have waited for
  std::jthread thread_;
};

/// Of an event, or a line of a log; 0 where it has none.
std::uint64_t number_of(const segue::type::Value& line);

}  // namespace ros2
