// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace segue::draw {

/// Tasks and their connections, as lists and pictures show them. A plain value; one thread at a time.
struct TaskGraph {
  /// A task, as `segue status` shows it.
  struct Task {
    std::string id;
    std::string component;
    std::string state;
    std::string process;                   ///< "HOST/PROCESS"; empty: that of the runtime
    std::vector<std::string> unwritten{};  ///< inputs that no connection leads to
  };
  /// A connection between two of the tasks.
  struct Connection {
    std::string from_task;
    std::string from_port;
    std::string to_task;
    std::string to_port;
    std::string policy;  ///< "data", "buffer", ...
  };
  std::string name;
  std::vector<Task> tasks;
  std::vector<Connection> connections;  ///< between tasks of the graph
};

/// The tasks' indices along the connections: those that nothing leads to first; of a loop the one that comes
/// first in the graph.
std::vector<std::uint32_t> order_of_flow(const TaskGraph& graph);

/// A graph for Graphviz, with a cluster for each process.
std::string to_dot(const TaskGraph& graph);
/// A drawing from left to right along the connections, a colour for each process. Connections that close a
/// loop are drawn in another colour, and their arrows stand at their reader's right side.
std::string to_svg(const TaskGraph& graph);

}  // namespace segue::draw
