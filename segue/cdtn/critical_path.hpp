// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/cdtn/order.hpp>
#include <segue/cdtn/run_result.hpp>
#include <segue/cdtn/task_network.hpp>

#include <cstdint>
#include <vector>

namespace segue::cdtn {

/// The longest chain of nodes that the order allows no way around: no run is shorter, whatever the resources.
/// Linear.
struct CriticalPath {
  Duration length{};
  std::vector<NodeId> nodes;  ///< in program order
};

/// With expected durations, all nodes on the path.
CriticalPath critical_path(const TaskNetwork& network, const Order& order);
/// With the durations and the skipped nodes of a run.
CriticalPath critical_path(const TaskNetwork& network, const Order& order, const RunResult& result);

/// Priorities for ConcurrentEngineOptions: who has the longest way to the end goes first.
std::vector<std::uint64_t> critical_path_priorities(const TaskNetwork& network, const Order& order);

}  // namespace segue::cdtn
