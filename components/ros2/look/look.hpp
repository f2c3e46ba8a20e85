// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

namespace ros2 {

/// A look at a running system of ROS 2.
struct Look {
  std::int32_t domain = -1;                            ///< as settings_from() takes it
  std::string discovery{};                             ///< as settings_from() takes it
  segue::Duration wait = std::chrono::seconds(3);      ///< how long nodes are listened for
  segue::Duration patience = std::chrono::seconds(5);  ///< how long a node has for its answers
  std::vector<std::string> nodes{};  ///< these are asked; the look ends when they have been found
  bool all = false;                  ///< all nodes are asked
  bool containers = false;           ///< all containers are asked for their components
  bool types = false;                ///< and for types that are not built in
  bool brief = false;  ///< for names only: it ends when nothing more is found, and looks for no processes
};

/// The request of the program segue-ros2, a map of these by their names; durations are texts ("3s").
segue::Result<Look> parse_look(const segue::type::Value& request);

/// {domain: 7, nodes: [...], topics: [...], problems: [...]}: the domain that was looked at, nodes and topics
/// as of segue::ros2::describe_nodes() and describe_topics(), and a text for each container that does not
/// answer. Nodes that are asked have the entries of ask(). All nodes
/// have `process`: {pid, nodes, command: [WORD], installation, package, executable, remappings, arguments},
/// the latter as far as the command tells; without `process` it is not on this computer, or is not this
/// user's. The containers of nodes that are asked are asked, too, and add_components() adds what they tell.
/// NotFound: a node that is named is not there. Other failures are those of Participant::join(); Cancelled by
/// `stop`.
segue::Result<segue::type::Value> look(const Look& request, const std::stop_token& stop);

}  // namespace ros2
