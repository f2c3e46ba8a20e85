// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/cdtn/completion_queue.hpp>
#include <segue/cdtn/environment.hpp>
#include <segue/cdtn/run_result.hpp>
#include <segue/cdtn/task_network.hpp>

#include <stop_token>

namespace segue::cdtn {

/// The reference: one node after the other in program order, each in reality. It shares nothing with the
/// engine but the clock and what the end of a node means, so that each can be tested by the other. Ends at
/// the first failure, and soon where `stop` is asked for, from any thread: then the node that runs is
/// preempted and none follows. Blocks.
RunResult run_sequential(const TaskNetwork& network, Environment& environment,
                         ClockKind clock = ClockKind::Virtual, std::stop_token stop = {});

}  // namespace segue::cdtn
