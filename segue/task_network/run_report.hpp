// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_network/run_result.hpp>
#include <segue/task_network/run_summary.hpp>
#include <segue/task_network/task_network.hpp>
#include <segue/task_network/waits.hpp>
#include <segue/type/value.hpp>

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace segue::task_network {

/// "done", "skipped" ...
std::string_view to_string(NodeStatus status);
/// "done", "stopped" or "failed".
std::string_view outcome_of(const RunResult& result);

/// Which nodes lists and drawings of a run show: all, or those that began. How many others there are of a
/// plan that is made while it runs depends on how far planning was ahead when it ended.
enum class ListedNodes : std::uint8_t { All, Begun };
/// In program order. Of structural nodes only those that failed.
std::vector<NodeId> listed_nodes(const TaskNetwork& network, const RunResult& result, ListedNodes which);

/// A wait as JSON; `node` is the name of the node whose end it was, or empty.
type::Value to_value(const Wait& wait, const std::string& node);

/// Of the nodes of a run, the structural ones aside. `waits` is of this run, here and below.
SpeculationSummary speculation_of(const TaskNetwork& network, const RunResult& result,
                                  const WaitFinder& waits);

/// The document that `segue mission run --format json` prints, with the nodes of `listed`.
type::Value to_value(const TaskNetwork& network, const RunResult& result, const WaitFinder& waits,
                     std::span<const NodeId> listed, const RunSummary& summary);

}  // namespace segue::task_network
