// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <optional>
#include <string>
#include <vector>

#include "command.hpp"

namespace segue::cli {

/// Where and how long a running system of ROS 2 is looked at.
struct Ros2SystemOptions {
  std::optional<int> domain;  ///< nothing: as the environment says
  std::string discovery;      ///< empty: as the environment says
  Duration wait = std::chrono::seconds(3);
  Duration patience = std::chrono::seconds(5);
};

/// --domain, --discovery, --wait; and where nodes are asked, --timeout.
void add_ros2_system_options(Verb& verb, Ros2SystemOptions& options, bool asks);

/// The nodes and topics of the running system, as the program segue-ros2 of the package of that name tells
/// them; it alone loads Fast DDS. `request` names what is asked of nodes: {all: true}, {nodes: [NODE]},
/// {types: true}, {containers: true}; {brief: true}: names only. Unavailable where the program is not
/// installed; else the error that it has. Ctrl-C, which ends this process, ends the program, too.
Result<type::Value> look_at_ros2(const Ros2SystemOptions& options, type::Value request);

/// For completion: the names of nodes that a short look finds, but for hidden ones; none where it fails.
std::vector<std::string> ros2_node_names();

/// Says on standard error what of the system could not be looked at.
void print_problems(const type::Value& seen);

/// The list at `key` of a node or topic as "a, b".
std::string joined_names(const type::Value& list);

}  // namespace segue::cli
