// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "conversions.hpp"

#include <cstddef>
#include <cstdint>

/// How many elements messages have, and messages with room for that many, so that updates allocate nothing.
namespace ros2_messages {

template <class Message>
std::size_t elements(const Message&) {
  return 0;
}
inline std::size_t elements(const messages::LaserScan& scan) {
  return scan.ranges.size();
}
inline std::size_t elements(const messages::Image& image) {
  return image.rgb.size();
}
inline std::size_t elements(const messages::JointState& joints) {
  return joints.positions.size();
}
inline std::size_t elements(const messages::OccupancyGrid& map) {
  return map.cells.size();
}
inline std::size_t elements(const messages::Path& path) {
  return path.poses.size();
}
inline std::size_t elements(const sensor_msgs::LaserScan& scan) {
  return scan.ranges.size();
}
inline std::size_t elements(const sensor_msgs::JointState& joints) {
  return joints.name.size();
}
inline std::size_t elements(const nav_msgs::OccupancyGrid& map) {
  return map.data.size();
}
inline std::size_t elements(const nav_msgs::Path& path) {
  return path.poses.size();
}
inline std::size_t elements(const sensor_msgs::Image& image) {
  return std::size_t{3} * image.width * image.height;
}

/// One with that many elements; as the names are.
template <class Message>
Message largest(std::size_t, const Names&) {
  return {};
}
template <>
inline messages::LaserScan largest(std::size_t most, const Names&) {
  messages::LaserScan scan;
  scan.ranges.resize(most);
  return scan;
}
template <>
inline messages::JointState largest(std::size_t most, const Names&) {
  messages::JointState joints;
  for (auto* values : {&joints.positions, &joints.velocities, &joints.efforts})
    values->resize(most);
  return joints;
}
template <>
inline messages::OccupancyGrid largest(std::size_t most, const Names&) {
  messages::OccupancyGrid map;
  map.cells.resize(most);
  return map;
}
template <>
inline messages::Path largest(std::size_t most, const Names&) {
  messages::Path path;
  path.poses.resize(most);
  return path;
}
template <>
inline messages::Image largest(std::size_t most, const Names&) {
  messages::Image image;
  image.rgb.resize(most);
  return image;
}
template <>
inline geometry_msgs::PoseStamped largest(std::size_t, const Names& names) {
  geometry_msgs::PoseStamped pose;
  pose.header.frame_id = names.frame;
  return pose;
}
template <>
inline sensor_msgs::LaserScan largest(std::size_t most, const Names& names) {
  sensor_msgs::LaserScan scan;
  scan.header.frame_id = names.frame;
  scan.ranges.resize(most);
  return scan;
}
template <>
inline sensor_msgs::Imu largest(std::size_t, const Names& names) {
  sensor_msgs::Imu imu;
  imu.header.frame_id = names.frame;
  return imu;
}
template <>
inline sensor_msgs::Image largest(std::size_t most, const Names& names) {
  sensor_msgs::Image image;
  image.header.frame_id = names.frame;
  image.data.resize(most);
  return image;
}
template <>
inline sensor_msgs::JointState largest(std::size_t most, const Names& names) {
  sensor_msgs::JointState joints;
  joints.header.frame_id = names.frame;
  joints.name = names.joints;
  for (auto* values : {&joints.position, &joints.velocity, &joints.effort})
    values->resize(most);
  return joints;
}
template <>
inline nav_msgs::Odometry largest(std::size_t, const Names& names) {
  nav_msgs::Odometry odometry;
  odometry.header.frame_id = names.frame;
  odometry.child_frame_id = names.child;
  return odometry;
}
template <>
inline tf2_msgs::TFMessage largest(std::size_t, const Names& names) {
  tf2_msgs::TFMessage message;
  message.transforms.resize(1);
  message.transforms.front().header.frame_id = names.frame;
  message.transforms.front().child_frame_id = names.child;
  return message;
}
template <>
inline nav_msgs::OccupancyGrid largest(std::size_t most, const Names& names) {
  nav_msgs::OccupancyGrid map;
  map.header.frame_id = names.frame;
  map.data.resize(most);
  return map;
}
template <>
inline nav_msgs::Path largest(std::size_t most, const Names& names) {
  nav_msgs::Path path;
  path.header.frame_id = names.frame;
  path.poses.resize(most);
  for (geometry_msgs::PoseStamped& pose : path.poses)
    pose.header.frame_id = names.frame;
  return path;
}

}  // namespace ros2_messages
