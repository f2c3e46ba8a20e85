// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/describe.hpp>
#include <segue/type/eigen.hpp>

#include <vector>

/// Messages between the components of mobile robots and arms. Lengths in metres, angles in radians, `time` in
/// seconds of the robot's clock. Frames are right-handed: x forward, y to the left, z upward; those of
/// cameras: x to the right, y downward, z forward.
namespace messages {

/// A pose in a plane; theta is measured counterclockwise from the x axis.
struct Pose2D {
  double x = 0;
  double y = 0;
  double theta = 0;
};

/// A velocity in a plane, in the frame of the moving body.
struct Twist2D {
  double linear = 0;   ///< m/s, forward
  double angular = 0;  ///< rad/s, counterclockwise
};

/// Where a vehicle is, in the frame in which it started, and how it moves.
struct Odometry {
  double time = 0;
  Pose2D pose;
  Twist2D twist;
};

struct Pose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
};

/// A pose and when it was that.
struct TimedPose {
  double time = 0;
  Pose pose;
};

struct Twist {
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();   ///< m/s
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();  ///< rad/s
};

/// Poses to be passed one after the other.
struct Path {
  Pose2D goal;  ///< that was asked for; the last pose may be another one near it
  std::vector<Pose2D> poses;
};

/// A map of square cells, row by row from the corner with the smallest x and y.
struct OccupancyGrid {
  double time = 0;
  double resolution = 0.05;  ///< m, side of a cell
  double x = 0;              ///< m, of the corner of the first cell
  double y = 0;
  std::uint32_t width = 0;         ///< cells in a row
  std::uint32_t height = 0;        ///< rows
  std::vector<std::int8_t> cells;  ///< percent that the cell is occupied, or -1: unknown
};

SEGUE_TYPE(Pose2D, x, y, theta)
SEGUE_TYPE(Twist2D, linear, angular)
SEGUE_TYPE(Odometry, time, pose, twist)
SEGUE_TYPE(Pose, position, orientation)
SEGUE_TYPE(TimedPose, time, pose)
SEGUE_TYPE(Twist, linear, angular)
SEGUE_TYPE(Path, goal, poses)
SEGUE_TYPE(OccupancyGrid, time, resolution, x, y, width, height, cells)

}  // namespace messages
