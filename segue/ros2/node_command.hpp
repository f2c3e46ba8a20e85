// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace segue::ros2 {

/// The command line of a node's process, in its parts.
struct NodeCommand {
  std::string installation;  ///< "/opt/ros/jazzy", of PREFIX/lib/PACKAGE/EXECUTABLE
  std::string package;
  std::string executable;
  std::vector<std::string> remappings{};  ///< "scan:=/front/scan"; without those of the node's own name
  std::vector<std::string> arguments{};   ///< those that are not for ROS 2
  friend bool operator==(const NodeCommand&, const NodeCommand&) = default;
};

/// `words` are those of the process: the program, which may be run by an interpreter, and its arguments. ROS
/// 2's own are between "--ros-args" and "--"; of these remappings are taken (-r FROM:=TO, --remap), while
/// parameters are left out. Nothing where the program does not lie in an installation of packages.
std::optional<NodeCommand> parse_node_command(const std::vector<std::string>& words);

}  // namespace segue::ros2
