// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_network/completion_queue.hpp>
#include <segue/task_network/environment.hpp>
#include <segue/task_network/run_result.hpp>
#include <segue/task_network/task_network.hpp>

#include <stop_token>

namespace segue::task_network {

/// The reference execution: one node at a time, in program order, in the real world. It shares only the clock
/// and the meaning of a node's end with ConcurrentEngine, so that tests can compare the two. Ends at the
/// first failure. `stop` may be requested on any thread: the running node is preempted and no further one
/// starts. Blocks.
RunResult run_sequential(const TaskNetwork& network, Environment& environment,
                         ClockKind clock = ClockKind::Virtual, std::stop_token stop = {});

}  // namespace segue::task_network
