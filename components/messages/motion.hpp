// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/describe.hpp>

#include <vector>

/// Motions as planners tell them those who carry them out. Units and frames: geometry.hpp.
namespace messages {

/// Configurations of a group of joints, to be passed along straight lines between them, from the first to the
/// last one.
struct JointPath {
  std::vector<std::vector<double>> points;  ///< each: rad or m, in the order of the joints' driver
};

SEGUE_TYPE(JointPath, points)

}  // namespace messages
