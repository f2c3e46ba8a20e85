// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/cdtn/completion_queue.hpp>
#include <segue/cdtn/environment.hpp>
#include <segue/cdtn/run_result.hpp>
#include <segue/cdtn/task_network.hpp>

#include <stop_token>

namespace segue::cdtn {

/// The reference execution: one node at a time, in program order, in the real world. It shares only the clock
/// and the meaning of a node's end with ConcurrentEngine, so that tests can compare the two. Ends at the
/// first failure. `stop` may be requested on any thread: the running node is preempted and no further one
/// starts. Blocks.
RunResult run_sequential(const TaskNetwork& network, Environment& environment,
                         ClockKind clock = ClockKind::Virtual, std::stop_token stop = {});

}  // namespace segue::cdtn
