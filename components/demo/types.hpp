// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/describe.hpp>

#include <string>
#include <vector>

/// A small two-wheeled robot in a room with round obstacles, to try out switching between controllers.
/// Lengths in metres, angles in radians, times in seconds.
namespace demo {

/// A pose in the room; theta is measured counterclockwise from the x axis.
struct Pose {
  double x = 0;
  double y = 0;
  double theta = 0;
};

/// The actual or commanded velocity of the robot.
struct Velocity {
  double forward = 0;  ///< m/s
  double turn = 0;     ///< rad/s
};

/// Distances around the robot, counterclockwise from `first_angle` (in the robot's frame), `step` apart.
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

/// A way through the room.
struct Route {
  std::string outcome;  ///< "found" or "no_route"
  std::vector<Point> points;
  double length = 0;  ///< m
};

SEGUE_TYPE(Pose, x, y, theta)
SEGUE_TYPE(Velocity, forward, turn)
SEGUE_TYPE(Scan, first_angle, step, ranges)
SEGUE_TYPE(Point, x, y)
SEGUE_TYPE(Obstacle, x, y, radius)
SEGUE_TYPE(Route, outcome, points, length)

}  // namespace demo
