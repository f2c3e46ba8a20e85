// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/mission/mission.hpp>
#include <segue/mission_plan/plan_mapping.hpp>
#include <segue/pddl/pddl.hpp>

#include <filesystem>
#include <optional>
#include <string_view>

namespace segue::mission {

/// A plan as a mission: a state for each step, one after the other, whose action is the one that the mapping
/// binds, with the facts and effects of the step; a concurrent run derives from these what may run at once.
/// The mission ends with `done`, or with `failed` where an action ends with another outcome than the mapping
/// names. Facts that must hold during a step are watched where they are observed. `folder` is that of the
/// mission's file, to which its scripts are relative. Nothing, and diagnostics, where the mapping lacks an
/// action or an object of the plan.
std::optional<Mission> planned_mission(const PlanMapping& mapping, const pddl::PddlPlan& plan,
                                       const std::filesystem::path& folder, Diagnostics& diagnostics);

}  // namespace segue::mission
