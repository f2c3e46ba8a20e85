// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/convert/mission_plan.hpp>
#include <segue/task_network/order.hpp>
#include <segue/task_network/run_result.hpp>

#include <string>
#include <vector>

namespace segue::convert {

/// The reasons why a run that has ended did not do more at the same time, one sentence for each: actions that
/// may touch anything, and states that ran sequentially. Empty where facts, data and resources alone decided.
[[nodiscard]] std::vector<std::string> why_in_sequence(const MissionPlan& plan,
                                                       const task_network::Order& order,
                                                       const task_network::RunResult& result);

}  // namespace segue::convert
