// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/task_network/order.hpp>
#include <segue/task_network/run_result.hpp>
#include <segue/task_network/task_network.hpp>

#include <cstdint>
#include <vector>

namespace segue::task_network {

/// The longest chain of dependent nodes: a lower bound of the makespan, whatever the resources. Linear time.
struct CriticalPath {
  Duration length{};
  std::vector<NodeId> nodes;  ///< in program order
};

/// The critical path with the expected durations, as if all nodes were executed.
CriticalPath critical_path(const TaskNetwork& network, const Order& order);
/// The critical path with the durations of a run, without the nodes that it skipped or preempted. A node that
/// could be planned only once another one had ended comes after that.
CriticalPath critical_path(const TaskNetwork& network, const Order& order, const RunResult& result);
/// How long at least the run takes because of resources: the longest time for which all units of one resource
/// are in use.
Duration busiest_resource(const TaskNetwork& network, const RunResult& result);

/// Priorities for ConcurrentEngineOptions: the node with the longest remaining path comes first.
std::vector<std::uint64_t> critical_path_priorities(const TaskNetwork& network, const Order& order);

}  // namespace segue::task_network
