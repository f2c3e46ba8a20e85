// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../messages/geometry.hpp"

#include <array>

namespace rover {

/// How a camera without distortion projects, in pixels.
struct Projection {
  double focal_length;
  double centre_x;
  double centre_y;
};

/// Corners of a marker in an image, as seen by an upright viewer: lower left, lower right, upper right, upper
/// left.
using Corners = std::array<Eigen::Vector2d, 4>;

/// The pose of a square marker in the frame of the camera: x to its right, y downward, z into its surface.
/// Two poses of a plane look nearly the same, mirrored at the line of sight (Schweighofer and Pinz, "Robust
/// Pose Estimation from a Planar Target", PAMI 2006): that one is returned whose corners are closer to those
/// in the image. `side`: m. `homography` takes (-1..1, -1..1) of the marker to pixels.
messages::Pose marker_pose(const Corners& corners, const Eigen::Matrix3d& homography, double side,
                           const Projection& projection);

}  // namespace rover
