// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../messages/poses.hpp"

/// Computes velocities that lead to a pose. Real-time safe; any thread.
namespace manipulation {

using messages::Pose;
using messages::Twist;

/// The way from `from` to `to`: a translation, and a rotation as axis times angle (at most pi), both in the
/// frame in which the poses are given.
struct PoseError {
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  ///< m
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();     ///< rad
};
[[nodiscard]] PoseError error_between(const Pose& from, const Pose& to);

struct ServoLimits {
  double gain = 2;         ///< 1/s: velocity per distance
  double speed = 0.25;     ///< m/s
  double turn_rate = 1.0;  ///< rad/s
};

/// The velocity towards the pose; translation and rotation each along the shortest way, slower close to the
/// end.
[[nodiscard]] Twist velocity_towards(const PoseError& error, const ServoLimits& limits);

}  // namespace manipulation
