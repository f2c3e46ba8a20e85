// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/cdtn/concurrent_engine.hpp>
#include <segue/cdtn/simulation.hpp>

#include <cstdint>
#include <stop_token>
#include <vector>

namespace segue::cdtn {

/// Whom the engine should prefer among nodes that could go: program order or the longest way to the end,
/// whichever a simulation in virtual time with these options finds shorter. The answer is for
/// ConcurrentEngineOptions::priorities; empty is program order, which is also the answer at a tie, and where
/// `stop` is asked for, from any thread.
std::vector<std::uint64_t> choose_priorities(const TaskNetwork& network, const Order& order,
                                             std::vector<Trial> trials, ConcurrentEngineOptions options,
                                             std::stop_token stop = {});

}  // namespace segue::cdtn
