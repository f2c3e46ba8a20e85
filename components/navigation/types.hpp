// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../messages/geometry.hpp"

#include <segue/type/describe.hpp>

#include <cstdint>

/// Reports of the components of this folder. Units and frames: messages/geometry.hpp.
namespace navigation {

/// Why there is no path.
enum class PlanProblem : std::uint8_t {
  None,
  NoGoal,
  NoPose,
  NoMap,
  InvalidMap,    ///< its fields contradict each other, or it has more cells than there is memory for
  StartOutside,  ///< of the map
  StartOccupied,
  GoalOutside,
  GoalOccupied,   ///< or too close to what is occupied for the vehicle
  GoalUnknown,    ///< and unknown cells may not be crossed
  NoWay,          ///< start and goal are not connected by cells that the vehicle can cross
  TooManyCorners  ///< the path has more poses than there is memory for
};

/// The result of the last attempt to find a path.
struct PlanStatus {
  messages::Pose2D goal;
  PlanProblem problem = PlanProblem::NoGoal;
  double length = 0;  ///< m, of the path
};

/// How far a vehicle is on its way to the goal of a path.
struct DriveProgress {
  messages::Pose2D goal;  ///< of the path that it follows
  bool arrived = false;
  double remaining = 0;  ///< m, along the path to its end
};

SEGUE_TYPE(PlanProblem, None, NoGoal, NoPose, NoMap, InvalidMap, StartOutside, StartOccupied, GoalOutside,
           GoalOccupied, GoalUnknown, NoWay, TooManyCorners)
SEGUE_TYPE(PlanStatus, goal, problem, length)
SEGUE_TYPE(DriveProgress, goal, arrived, remaining)

}  // namespace navigation
