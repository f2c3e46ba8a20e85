// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/ros2/node_graph.hpp>

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace ros2 {

/// A UDP socket of IPv4 in this network namespace.
struct UdpSocket {
  std::uint16_t port = 0;
  std::string file;  ///< "socket:[INODE]", to which the descriptors of its processes link
};
/// All there are (/proc/net/udp; proc_net(5)).
std::vector<UdpSocket> udp_sockets();

/// The one of these processes from which the others have their sockets: they are inherited by children.
/// Numbers of processes say nothing of that, since they begin anew. Nothing where all have ended.
std::optional<pid_t> first_of(const std::vector<pid_t>& processes);

/// The process of this computer that receives there. Nothing where the address is another computer's, or the
/// process is another user's or in another network namespace. Neither Fast DDS nor Cyclone DDS tells others
/// the number of its process in all versions, but each participant has a port of its own.
std::optional<pid_t> process_at(const segue::ros2::UdpAddress& address);

/// The words of its command line; empty where the process has ended.
std::vector<std::string> command_of(pid_t process);

/// A variable of the environment that it was started with; empty where it has none, or has ended, or is
/// another user's.
std::string variable_of(pid_t process, std::string_view name);

/// The files that it has mapped, such as its libraries, without links in their paths; none where it is
/// another user's.
std::set<std::string> mapped_files(pid_t process);

}  // namespace ros2
