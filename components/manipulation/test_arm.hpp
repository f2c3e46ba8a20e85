// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "types.hpp"

#include <vector>

/// For tests only: an arm with seven joints, 1.1 m long.
namespace manipulation::test {

inline std::vector<JointDescription> seven_joints() {
  const Eigen::Vector3d up(0, 0, 1);
  const Eigen::Vector3d aside(0, 1, 0);
  const auto joint = [](const char* name, double height, const Eigen::Vector3d& axis, double range) {
    JointDescription made;
    made.name = name;
    made.xyz = {0, 0, height};
    made.axis = axis;
    made.lower = -range;
    made.upper = range;
    made.velocity = 1.5;
    return made;
  };
  return {joint("turn", 0.1, up, 2.9),  joint("shoulder", 0.2, aside, 2.0),
          joint("upper", 0.2, up, 2.9), joint("elbow", 0.2, aside, 2.4),
          joint("lower", 0.2, up, 2.9), joint("wrist", 0.1, aside, 2.0),
          joint("hand", 0.1, up, 2.9)};
}

/// Bent, far from singularities and ends of ranges.
inline std::vector<double> bent() {
  return {0.3, 0.5, -0.2, 1.2, 0.4, 0.8, -0.3};
}

}  // namespace manipulation::test
