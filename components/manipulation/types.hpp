// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../messages/geometry.hpp"

#include <segue/type/describe.hpp>

#include <string>
#include <vector>

/// Properties and states of the components of this folder. Units and frames: messages/geometry.hpp.
namespace manipulation {

/// A joint and the link that it moves, as in URDF: the origin is given in the frame of the link before, the
/// axis in the frame at the origin. Angles are rotations about the fixed axes x, y and z, in this order.
struct JointDescription {
  std::string name;
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();          ///< m
  Eigen::Vector3d rpy = Eigen::Vector3d::Zero();          ///< rad
  Eigen::Vector3d axis = Eigen::Vector3d(0.0, 0.0, 1.0);  ///< need not have length 1
  bool prismatic = false;                                 ///< it slides along the axis instead of turning
  double lower = -3.1;                                    ///< rad or m
  double upper = 3.1;                                     ///< rad or m
  double velocity = 1.0;                                  ///< rad/s or m/s, at most
};

/// The limits of a joint, for the generation of trajectories.
struct JointLimit {
  double lower = -3.1;        ///< rad or m; -.inf and .inf for joints that turn endlessly
  double upper = 3.1;         ///< rad or m
  double velocity = 1.0;      ///< rad/s or m/s
  double acceleration = 3.0;  ///< rad/s^2 or m/s^2
  double jerk = 30.0;         ///< rad/s^3 or m/s^3
};

/// The state that one trajectory generator hands over to the next.
struct TrajectoryState {
  std::vector<double> positions;
  std::vector<double> velocities;
  std::vector<double> accelerations;
};

/// A named configuration of an arm.
struct Waypoint {
  std::string name;
  std::vector<double> positions;  ///< rad or m
};

/// A velocity that is kept for a time.
struct TimedTwist {
  messages::Twist twist;
  double duration = 1.0;  ///< s
};

SEGUE_TYPE(JointDescription, name, xyz, rpy, axis, prismatic, lower, upper, velocity)
SEGUE_TYPE(JointLimit, lower, upper, velocity, acceleration, jerk)
SEGUE_TYPE(TrajectoryState, positions, velocities, accelerations)
SEGUE_TYPE(Waypoint, name, positions)
SEGUE_TYPE(TimedTwist, twist, duration)

}  // namespace manipulation
