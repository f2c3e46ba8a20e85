// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include <string>
#include <vector>

#include "../new_folder.hpp"

namespace segue::cli {

/// The robot of a running system of ROS 2.
struct Ros2Robot {
  std::vector<NewFile> files;
  std::vector<std::string> nodes;    ///< those that have become tasks
  std::vector<std::string> started;  ///< of these, those that the robot starts
};

/// Makes it of what look_at_ros2() tells, with all nodes asked: a robot file, and the controller "nodes" with
/// a task for each node (ros2::ManagedNode, ros2::Node), with its parameters, and how its program is started
/// unless `starts` is false. Nodes of Segue's own tasks, and hidden ones (whose names begin with '_'), are
/// left out.
Ros2Robot ros2_robot(const type::Value& seen, const std::string& name, bool starts);

/// Nodes that were asked, as tasks to be pasted into a network: as ros2_robot() writes them, and with their
/// topics as ports.
std::string ros2_tasks(const std::vector<type::Value>& nodes);

}  // namespace segue::cli
