// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../participant/participant.hpp"
#include "../participant/types.hpp"
#include "../services/service_executor.hpp"
#include "exposed_node.hpp"
#include "exposed_task.hpp"
#include "robot_log.hpp"
#include "robot_parameters.hpp"
#include "shown_nodes.hpp"

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/control/robot_service.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace ros2 {

/// Which tasks of a robot are exposed, and how.
struct ExposedRobotSettings {
  std::filesystem::path socket;    ///< of the robot
  std::vector<std::string> tasks;  ///< names, or patterns with '*'; none: all
  std::string name_space;          ///< of their nodes, without a '/' at its end: "", "/robot"
  std::string own_task;            ///< which exposes them
  std::string own_node;            ///< "/robot/exposure": as which it is seen itself
  std::shared_ptr<Rosout> rosout;  ///< where the robot's log goes; nullptr: nowhere
  std::shared_ptr<MessageWriter> parameter_events;
};

/// The tasks of a robot as nodes of ROS 2, in threads of its own: connects with the robot, follows which
/// tasks it has and how they are, and withdraws all nodes where the connection is lost.
class ExposedRobot {
 public:
  /// `changed` is called in one of these threads when trouble() may be another one.
  ExposedRobot(std::shared_ptr<Participant> participant, ExposedRobotSettings settings, ExposureRules rules,
               std::function<void()> changed);
  /// Withdraws all nodes. Waits for nobody: requests in progress are given up.
  ~ExposedRobot();
  ExposedRobot(const ExposedRobot&) = delete;
  ExposedRobot& operator=(const ExposedRobot&) = delete;

  /// Why nothing is exposed; empty: the robot is connected, or has been waited for not long enough.
  [[nodiscard]] std::string trouble() const;
  [[nodiscard]] ExposureStatistics statistics() const;

 private:
  class Inbox;
  struct Node {
    std::unique_ptr<ExposedNode> node;
    std::string component;
    std::uint64_t number = 0;  ///< of all nodes that there were
    std::optional<segue::task_host::TaskLevel> seen{};
    bool is_watched = false;
  };
  /// A robot that is connected, and what is exposed of it.
  struct Connection {
    std::shared_ptr<segue::control::RobotService> robot;
    std::stop_source ends{};
    std::shared_ptr<Inbox> inbox;
    std::map<std::string, Node> nodes{};  ///< by task
    std::uint64_t last_number = 0;
    std::unique_ptr<RobotLog> log{};
    std::unique_ptr<RobotParameters> parameters{};
  };

  void run(const std::stop_token& stop);
  /// Until the connection is lost, which it says why, or the stop.
  segue::Result<void> follow(std::shared_ptr<segue::control::RobotService> robot,
                             const std::stop_token& stop);
  static void ask_for_changes(Connection& connection);
  /// Until there is something to ask the robot for.
  static void wait_for_news(Connection& connection, const std::stop_token& stop);
  void take_tasks(Connection& connection, const segue::type::Value& status);
  void add(Connection& connection, const segue::type::Value& task);
  static void watch(Connection& connection, const std::string& task);
  static void take_level(Connection& connection, const std::string& task, std::uint64_t number,
                         const segue::Result<segue::control::RobotLevel>& level);
  [[nodiscard]] bool is_exposed(const segue::type::Value& task) const;
  void log_once(const std::string& message);
  void note_nodes(const Connection& connection);
  void set_trouble(std::string trouble);

  const std::shared_ptr<Participant> participant_;
  const ExposedRobotSettings settings_;
  const ExposureRules rules_;
  const std::function<void()> changed_;
  ServiceExecutor executor_;
  std::set<std::string> said_;  ///< by the thread alone
  mutable segue::Mutex mutex_;
  std::string trouble_ SEGUE_GUARDED_BY(mutex_);
  ShownNodes nodes_ SEGUE_GUARDED_BY(mutex_);
  std::jthread thread_;
};

}  // namespace ros2
