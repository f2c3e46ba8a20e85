// SPDX-License-Identifier: Apache-2.0
#include "pose_servo.hpp"

#include <algorithm>
#include <cmath>

namespace manipulation {
namespace {

Eigen::Vector3d shortened(const Eigen::Vector3d& vector, double most) {
  const double length = vector.norm();
  return length > most ? Eigen::Vector3d(vector * (most / length)) : vector;
}

}  // namespace

PoseError error_between(const Pose& from, const Pose& to) {
  const Eigen::Quaterniond turn = to.orientation * from.orientation.conjugate();
  // Both signs of a quaternion are the same rotation; the positive real part is the short way round.
  const Eigen::Vector3d axis = turn.w() < 0 ? Eigen::Vector3d(-turn.vec()) : Eigen::Vector3d(turn.vec());
  const double sine = axis.norm();
  const double angle = 2 * std::atan2(sine, std::abs(turn.w()));
  return {to.position - from.position, sine > 1e-12 ? Eigen::Vector3d(axis * (angle / sine)) : 2 * axis};
}

Twist velocity_towards(const PoseError& error, const ServoLimits& limits) {
  return {shortened(limits.gain * error.translation, limits.speed),
          shortened(limits.gain * error.rotation, limits.turn_rate)};
}

}  // namespace manipulation
