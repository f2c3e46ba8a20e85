// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/describe.hpp>

#include <vector>

/// A small robot with two wheels in a room with round obstacles: enough to switch between controllers that do
/// something. Lengths in metres, angles in radians, times in seconds.
namespace demo {

/// Where the robot is in its room; theta counts anticlockwise from the x axis.
struct Pose {
  double x = 0;
  double y = 0;
  double theta = 0;
};

/// How the robot moves, or is to move.
struct Velocity {
  double forward = 0;  ///< m/s
  double turn = 0;     ///< rad/s
};

/// Distances around the robot, anticlockwise from `first_angle` (in the robot's frame), `step` apart.
struct Scan {
  double first_angle = 0;
  double step = 0;
  std::vector<double> ranges;
};

struct Point {
  double x = 0;
  double y = 0;
};

struct Obstacle {
  double x = 0;
  double y = 0;
  double radius = 0.5;
};

}  // namespace demo

SEGUE_TYPE(demo::Pose, x, y, theta)
SEGUE_TYPE(demo::Velocity, forward, turn)
SEGUE_TYPE(demo::Scan, first_angle, step, ranges)
SEGUE_TYPE(demo::Point, x, y)
SEGUE_TYPE(demo::Obstacle, x, y, radius)
