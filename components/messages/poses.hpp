// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry.hpp"

/// Arithmetic of poses in space. Real-time safe; any thread.
namespace messages {

/// Whether the pose consists of finite numbers and has an orientation, of whatever length.
[[nodiscard]] inline bool is_usable(const Pose& pose) {
  return pose.position.allFinite() && pose.orientation.coeffs().allFinite() && pose.orientation.norm() > 1e-6;
}

/// `inner`, given in the frame of `outer`, in the frame in which `outer` is given.
[[nodiscard]] inline Pose compose(const Pose& outer, const Pose& inner) {
  Pose result;
  result.position = outer.position + outer.orientation * inner.position;
  result.orientation = (outer.orientation * inner.orientation).normalized();
  return result;
}

[[nodiscard]] inline Pose inverse(const Pose& pose) {
  Pose result;
  result.orientation = pose.orientation.conjugate();
  result.position = -(result.orientation * pose.position);
  return result;
}

/// Between two poses: `from` for a share of 0, `to` for 1. Turns the shorter way.
[[nodiscard]] inline Pose interpolated(const Pose& from, const Pose& to, double share) {
  Pose pose;
  pose.position = from.position + share * (to.position - from.position);
  pose.orientation = from.orientation.slerp(share, to.orientation);
  return pose;
}

}  // namespace messages
