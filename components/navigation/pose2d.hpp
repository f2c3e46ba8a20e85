// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../messages/geometry.hpp"

#include <cmath>

/// Arithmetic of poses in a plane. Real-time safe; any thread.
namespace navigation {

using messages::Pose2D;

struct Point {
  double x = 0;
  double y = 0;
};

/// The angle, wrapped to the range from -pi to pi.
inline double wrapped(double angle) {
  return std::remainder(angle, 2 * M_PI);
}

inline bool is_same(const Pose2D& a, const Pose2D& b) {
  return a.x == b.x && a.y == b.y && a.theta == b.theta;
}

inline bool is_finite(const Pose2D& pose) {
  return std::isfinite(pose.x) && std::isfinite(pose.y) && std::isfinite(pose.theta);
}

/// `inner`, given in the frame of `outer`, in the frame in which `outer` is given.
inline Pose2D compose(const Pose2D& outer, const Pose2D& inner) {
  const double c = std::cos(outer.theta);
  const double s = std::sin(outer.theta);
  return {outer.x + c * inner.x - s * inner.y, outer.y + s * inner.x + c * inner.y,
          wrapped(outer.theta + inner.theta)};
}

inline Pose2D inverse(const Pose2D& pose) {
  const double c = std::cos(pose.theta);
  const double s = std::sin(pose.theta);
  return {-c * pose.x - s * pose.y, s * pose.x - c * pose.y, -pose.theta};
}

/// Where the vehicle is after it has driven for `duration` seconds on an arc.
inline Pose2D moved(const Pose2D& pose, const messages::Twist2D& twist, double duration) {
  const double turn = twist.angular * duration;
  const double half = 0.5 * turn;
  const double chord = twist.linear * duration * (std::abs(half) < 1e-6 ? 1.0 : std::sin(half) / half);
  return compose(pose, {chord * std::cos(half), chord * std::sin(half), turn});
}

}  // namespace navigation
