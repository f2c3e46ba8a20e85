// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry.hpp"

#include <cstdint>
#include <vector>

/// Messages from sensors and joints, and commands to joints. Units and frames: geometry.hpp.
namespace messages {

/// The joints of one group, in the order of its driver. Vectors are empty where the driver does not know.
struct JointState {
  double time = 0;
  std::vector<double> positions;   ///< rad or m
  std::vector<double> velocities;  ///< rad/s or m/s
  std::vector<double> efforts;     ///< N m or N
};

/// Set points for the joints of one group, in the order of its driver.
struct JointCommand {
  double time = 0;
  std::vector<double> positions;   ///< rad or m
  std::vector<double> velocities;  ///< rad/s or m/s
};

/// Distances around a sensor, counterclockwise from `first_angle`, `angle_step` apart.
struct LaserScan {
  double time = 0;
  double first_angle = 0;
  double angle_step = 0;
  double minimum_range = 0;
  double maximum_range = 0;
  std::vector<float> ranges;  ///< m; infinite where nothing was met
};

struct Imu {
  double time = 0;
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();     ///< rad/s
  Eigen::Vector3d linear_acceleration = Eigen::Vector3d::Zero();  ///< m/s^2, gravity included
};

/// A colour image without compression: three bytes a pixel (red, green, blue), row by row from the top.
struct Image {
  double time = 0;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> rgb;
};

struct Marker {
  std::int32_t id = 0;
  /// The pose of the marker's centre in the frame of the camera: x to the right and y downward for a reader
  /// of the upright marker, z into its surface.
  Pose pose;
};

/// The markers that were seen in one image; empty where none was.
struct Markers {
  double time = 0;
  std::vector<Marker> markers;
};

SEGUE_TYPE(JointState, time, positions, velocities, efforts)
SEGUE_TYPE(JointCommand, time, positions, velocities)
SEGUE_TYPE(LaserScan, time, first_angle, angle_step, minimum_range, maximum_range, ranges)
SEGUE_TYPE(Imu, time, orientation, angular_velocity, linear_acceleration)
SEGUE_TYPE(Image, time, width, height, rgb)
SEGUE_TYPE(Marker, id, pose)
SEGUE_TYPE(Markers, time, markers)

}  // namespace messages
