// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_network/concurrent_engine.hpp>
#include <segue/task_network/simulated_environment.hpp>

#include <cstdint>
#include <stop_token>
#include <vector>

namespace segue::task_network {

/// Chooses ConcurrentEngineOptions::priorities: program order or the longest remaining path first, whichever
/// gives the shorter makespan in a simulation in virtual time with these options. Empty means program order,
/// also at a tie and after a request on `stop`, which may come from any thread. Blocks for two simulations.
std::vector<std::uint64_t> choose_priorities(const TaskNetwork& network, const Order& order,
                                             std::vector<Trial> trials, ConcurrentEngineOptions options,
                                             std::stop_token stop = {});

}  // namespace segue::task_network
