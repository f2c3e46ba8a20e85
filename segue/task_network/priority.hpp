// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_network/concurrent_engine.hpp>
#include <segue/task_network/simulated_environment.hpp>

#include <cstdint>
#include <stop_token>
#include <vector>

namespace segue::task_network {

/// About half a second of simulation.
inline constexpr std::uint64_t kSimulatedNodes = 500'000;

/// Chooses ConcurrentEngineOptions::priorities by simulations in virtual time with these options: those with
/// which the run is shortest. Tries program order, the longest remaining path first, and then the order in
/// which nodes begin in the best run so far, disturbed at random, by more the longer that is in vain; the
/// same each time. Of more than 3000 nodes only the two rules are tried. Ends when the run cannot be shorter,
/// when about `most` nodes have been simulated, or after a request on `stop`, which may come from any thread.
/// Empty means program order. Blocks.
std::vector<std::uint64_t> choose_priorities(const TaskNetwork& network, const Order& order,
                                             std::vector<Trial> trials, ConcurrentEngineOptions options,
                                             std::stop_token stop = {}, std::uint64_t most = kSimulatedNodes);

}  // namespace segue::task_network
