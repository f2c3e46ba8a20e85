// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/host/local_task_host.hpp>
#include <segue/model/network.hpp>

#include <vector>

namespace segue::deploy::detail {

/// The network's tasks such that each stands after those that it gets samples from, where there is no cycle;
/// else in the network's order.
std::vector<model::TaskId> producers_first(const model::Network& network);

/// Stops and cleans up all tasks, producers first; slow ones side by side. Answers at `deadline` at the
/// latest. False: a hook has not returned. It still runs in its thread then, so `host` must never be
/// destroyed: end the process by std::_Exit.
bool shut_down(host::LocalTaskHost& host, TimePoint deadline);

}  // namespace segue::deploy::detail
