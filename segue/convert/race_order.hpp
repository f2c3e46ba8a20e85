// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/convert/mission_plan.hpp>

namespace segue::convert {

/// Whether `fails` is in a preemptive container, and `acts` in another of its states or after it. Then no
/// failure of the one can come after the other without coming so in the sequential run.
[[nodiscard]] bool beside_or_after_race(const MissionPlan& plan, task_network::NodeId acts,
                                        task_network::NodeId fails);

}  // namespace segue::convert
