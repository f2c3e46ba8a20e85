// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/convert/mission_plan.hpp>
#include <segue/mission/globals.hpp>
#include <segue/task_network/run_result.hpp>

#include <vector>

namespace segue::convert {

/// The outputs of a mission that failed or was stopped, by port: what its states had given until then, as in
/// the sequential run. Outputs of nodes after the failure that ended all the same do not count. Takes as long
/// as planning the run once more.
[[nodiscard]] std::vector<type::Value> unfinished_outputs(const MissionPlan& plan,
                                                          const task_network::RunResult& result,
                                                          const mission::Globals& globals);

}  // namespace segue::convert
