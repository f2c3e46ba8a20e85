// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "grid_search.hpp"

/// What the components of this folder report.
namespace navigation {

/// The result of the last attempt to find a path.
struct PlanStatus {
  Pose2D goal;
  PlanProblem problem = PlanProblem::NoGoal;
  double length = 0;  ///< m, of the path
};

}  // namespace navigation

SEGUE_TYPE(navigation::PlanStatus, goal, problem, length)
