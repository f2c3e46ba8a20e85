// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/ros2/node_graph.hpp>

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace ros2 {

/// The process of this computer that receives there. Nothing where the address is another computer's, or the
/// process is another user's or in another network namespace. Neither Fast DDS nor Cyclone DDS tells others
/// the number of its process in all versions, but each participant has a port of its own.
std::optional<pid_t> process_at(const segue::ros2::UdpAddress& address);

/// The words of its command line; empty where the process has ended.
std::vector<std::string> command_of(pid_t process);

}  // namespace ros2
