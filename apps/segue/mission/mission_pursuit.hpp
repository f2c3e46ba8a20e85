// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/robot_service.hpp>
#include <segue/mission_plan/plan_mapping.hpp>
#include <segue/model/robot.hpp>

#include <cstddef>
#include <optional>

#include "../command.hpp"
#include "planning.hpp"

namespace segue::cli {

/// A goal that a robot is to reach.
struct Goal {
  const mission::PlanMapping& mapping;
  PlanningText problem;  ///< with what is known of the world
  std::optional<model::PlannerProgram> planner;
  std::size_t most_plans = 5;
};

/// Plans from the world as the robot shows it, runs the mission of the plan, and where that does not end as
/// planned, plans anew from what the robot shows then, until the goal holds. The robot does not come to rest
/// in between, and what runs goes on as far as the next plan permits. Nothing is planned any more after a
/// stop, and once the robot is lost. Prints the runs; returns the exit status.
int pursue(Goal goal, control::RobotService& service, const Context& context);

}  // namespace segue::cli
