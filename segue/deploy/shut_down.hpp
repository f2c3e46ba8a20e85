// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/model/network.hpp>
#include <segue/task_host/action_pool.hpp>
#include <segue/task_host/local_task_host.hpp>

#include <vector>

namespace segue::deploy::detail {

/// The network's tasks in such an order that each comes after those that it reads from. Cycles are cut at
/// their first task in the network's order.
std::vector<model::TaskId> producers_first(const model::Network& network);

/// How long a hook may take before the next ones begin beside it.
inline constexpr Duration kShutDownPatience = std::chrono::milliseconds(20);

/// Stops and cleans up all tasks of `host` by `pool`, producers first; slow ones side by side. Answers at
/// `deadline` and a little at the latest. False: a hook has not returned. It still runs in its thread then,
/// so neither may be destroyed: end the process by std::_Exit.
bool shut_down(const task_host::LocalTaskHost& host, task_host::ActionPool& pool, TimePoint deadline);

}  // namespace segue::deploy::detail
