// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../messages/geometry.hpp"

#include <builtin_interfaces/msg/time.hpp>
#include <geometry_msgs/msg/quaternion.hpp>
#include <geometry_msgs/msg/vector3.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

/// Times, vectors and rotations as those of ROS 2, and the reverse. Real-time safe; any thread.
namespace ros2_messages {

constexpr double kNanoseconds = 1e9;

/// Of a time in seconds. Times that ROS 2 cannot tell are the nearest that it can.
inline builtin_interfaces::Time stamp(double time) {
  constexpr double kLast = std::numeric_limits<std::int32_t>::max();
  const double kept = std::isfinite(time) ? std::clamp(time, 0.0, kLast) : 0.0;
  const double seconds = std::floor(kept);
  const double rest = std::min(std::round((kept - seconds) * kNanoseconds), kNanoseconds - 1);
  return {static_cast<std::int32_t>(seconds), static_cast<std::uint32_t>(rest)};
}

inline double seconds(const builtin_interfaces::Time& time) {
  return time.sec + time.nanosec / kNanoseconds;
}

inline geometry_msgs::Vector3 vector(const Eigen::Vector3d& from) {
  return {from.x(), from.y(), from.z()};
}
inline Eigen::Vector3d vector(const geometry_msgs::Vector3& from) {
  return {from.x, from.y, from.z};
}

inline geometry_msgs::Quaternion rotation(const Eigen::Quaterniond& from) {
  return {from.x(), from.y(), from.z(), from.w()};
}
inline Eigen::Quaterniond rotation(const geometry_msgs::Quaternion& from) {
  return {from.w, from.x, from.y, from.z};
}

inline geometry_msgs::Quaternion about_z(double angle) {
  return {0, 0, std::sin(angle / 2), std::cos(angle / 2)};
}

/// The angle about z (REP-103).
inline double yaw(const Eigen::Quaterniond& q) {
  return std::atan2(2 * (q.w() * q.z() + q.x() * q.y()), 1 - 2 * (q.y() * q.y() + q.z() * q.z()));
}

}  // namespace ros2_messages
