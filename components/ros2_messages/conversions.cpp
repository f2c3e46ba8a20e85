// SPDX-License-Identifier: Apache-2.0
#include "conversions.hpp"

#include "quantities.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace ros2_messages {
namespace {

void set(std_msgs::Header& header, double time, const std::string& frame) {
  header.stamp = stamp(time);
  header.frame_id = frame;
}

geometry_msgs::Pose pose_in_plane(const messages::Pose2D& from) {
  return {{from.x, from.y, 0}, about_z(from.theta)};
}

messages::Pose2D pose_in_plane(const geometry_msgs::Pose& from) {
  return {from.position.x, from.position.y, yaw(rotation(from.orientation))};
}

}  // namespace

Problem convert(const messages::LaserScan& from, sensor_msgs::LaserScan& to, const Names& names) {
  set(to.header, from.time, names.frame);
  const auto steps = static_cast<double>(from.ranges.empty() ? 0 : from.ranges.size() - 1);
  to.angle_min = static_cast<float>(from.first_angle);
  to.angle_max = static_cast<float>(from.first_angle + from.angle_step * steps);
  to.angle_increment = static_cast<float>(from.angle_step);
  to.range_min = static_cast<float>(from.minimum_range);
  to.range_max = static_cast<float>(from.maximum_range);
  to.ranges = from.ranges;
  return nullptr;
}

Problem convert(const messages::Imu& from, sensor_msgs::Imu& to, const Names& names) {
  set(to.header, from.time, names.frame);
  to.orientation = rotation(from.orientation);
  to.angular_velocity = vector(from.angular_velocity);
  to.linear_acceleration = vector(from.linear_acceleration);
  return nullptr;
}

Problem convert(const messages::Image& from, sensor_msgs::Image& to, const Names& names) {
  set(to.header, from.time, names.frame);
  to.height = from.height;
  to.width = from.width;
  to.encoding = "rgb8";
  to.step = 3 * from.width;
  to.data = from.rgb;
  return from.rgb.size() == std::size_t{to.step} * to.height
             ? nullptr
             : "the image has another number of bytes than pixels";
}

Problem convert(const messages::JointState& from, sensor_msgs::JointState& to, const Names& names) {
  set(to.header, from.time, names.frame);
  to.name = names.joints;
  to.position = from.positions;
  to.velocity = from.velocities;
  to.effort = from.efforts;
  return from.positions.size() == names.joints.size()
             ? nullptr
             : "the property 'joints' names another number of joints";
}

Problem convert(const messages::Odometry& from, nav_msgs::Odometry& to, const Names& names) {
  set(to.header, from.time, names.frame);
  to.child_frame_id = names.child;
  to.pose.pose = pose_in_plane(from.pose);
  to.twist.twist = {{from.twist.linear, 0, 0}, {0, 0, from.twist.angular}};
  return nullptr;
}

Problem convert(const messages::Odometry& from, tf2_msgs::TFMessage& to, const Names& names) {
  to.transforms.resize(1);
  auto& transform = to.transforms.front();
  set(transform.header, from.time, names.frame);
  transform.child_frame_id = names.child;
  transform.transform = {{from.pose.x, from.pose.y, 0}, about_z(from.pose.theta)};
  return nullptr;
}

Problem convert(const messages::TimedPose& from, tf2_msgs::TFMessage& to, const Names& names) {
  to.transforms.resize(1);
  auto& transform = to.transforms.front();
  set(transform.header, from.time, names.frame);
  transform.child_frame_id = names.child;
  transform.transform = {vector(from.pose.position), rotation(from.pose.orientation)};
  return nullptr;
}

Problem convert(const messages::OccupancyGrid& from, nav_msgs::OccupancyGrid& to, const Names& names) {
  set(to.header, from.time, names.frame);
  to.info.map_load_time = to.header.stamp;
  to.info.resolution = static_cast<float>(from.resolution);
  to.info.width = from.width;
  to.info.height = from.height;
  to.info.origin = {{from.x, from.y, 0}, {0, 0, 0, 1}};
  to.data = from.cells;
  return from.cells.size() == std::size_t{from.width} * from.height
             ? nullptr
             : "the map has another number of cells than it says";
}

Problem convert(const messages::Path& from, nav_msgs::Path& to, const Names& names) {
  to.header.frame_id = names.frame;
  to.poses.resize(from.poses.size());
  for (std::size_t i = 0; i < from.poses.size(); ++i) {
    to.poses[i].header.frame_id = names.frame;
    to.poses[i].pose = pose_in_plane(from.poses[i]);
  }
  return nullptr;
}

Problem convert(const messages::Twist2D& from, geometry_msgs::Twist& to, const Names&) {
  to = {{from.linear, 0, 0}, {0, 0, from.angular}};
  return nullptr;
}

Problem convert(const messages::Pose2D& from, geometry_msgs::PoseStamped& to, const Names& names) {
  to.header.stamp = {};
  to.header.frame_id = names.frame;
  to.pose = pose_in_plane(from);
  return nullptr;
}

Problem convert(const double& time, rosgraph_msgs::Clock& to, const Names&) {
  to.clock = stamp(time);
  return nullptr;
}

Problem convert(const sensor_msgs::LaserScan& from, messages::LaserScan& to, const Names&) {
  to.time = seconds(from.header.stamp);
  to.first_angle = from.angle_min;
  to.angle_step = from.angle_increment;
  to.minimum_range = from.range_min;
  to.maximum_range = from.range_max;
  to.ranges = from.ranges;
  return nullptr;
}

Problem convert(const sensor_msgs::Imu& from, messages::Imu& to, const Names&) {
  to.time = seconds(from.header.stamp);
  to.orientation = rotation(from.orientation);
  to.angular_velocity = vector(from.angular_velocity);
  to.linear_acceleration = vector(from.linear_acceleration);
  return nullptr;
}

Problem convert(const sensor_msgs::JointState& from, messages::JointState& to, const Names& names) {
  const auto pick = [](const std::vector<double>& all, std::size_t index, std::vector<double>& picked) {
    if (index < all.size()) picked.push_back(all[index]);
  };
  to.time = seconds(from.header.stamp);
  for (auto* values : {&to.positions, &to.velocities, &to.efforts})
    values->clear();
  const auto& wanted = names.joints.empty() ? from.name : names.joints;
  for (const std::string& joint : wanted) {
    const auto found = std::ranges::find(from.name, joint);
    if (found == from.name.end()) return "a joint of the property 'joints' is missing";
    const auto index = static_cast<std::size_t>(found - from.name.begin());
    pick(from.position, index, to.positions);
    pick(from.velocity, index, to.velocities);
    pick(from.effort, index, to.efforts);
  }
  const auto is_whole = [&](const std::vector<double>& values) {
    return values.empty() || values.size() == wanted.size();
  };
  return is_whole(to.positions) && is_whole(to.velocities) && is_whole(to.efforts)
             ? nullptr
             : "some joints have a value, others do not";
}

Problem convert(const nav_msgs::Odometry& from, messages::Odometry& to, const Names&) {
  to.time = seconds(from.header.stamp);
  to.pose = pose_in_plane(from.pose.pose);
  to.twist = {from.twist.twist.linear.x, from.twist.twist.angular.z};
  return nullptr;
}

Problem convert(const geometry_msgs::Twist& from, messages::Twist2D& to, const Names&) {
  to = {from.linear.x, from.angular.z};
  return nullptr;
}

Problem convert(const geometry_msgs::PoseStamped& from, messages::Pose2D& to, const Names&) {
  to = pose_in_plane(from.pose);
  return nullptr;
}

Problem convert(const nav_msgs::OccupancyGrid& from, messages::OccupancyGrid& to, const Names&) {
  constexpr double kStraight = 1e-6;
  to.time = seconds(from.header.stamp);
  to.resolution = from.info.resolution;
  to.x = from.info.origin.position.x;
  to.y = from.info.origin.position.y;
  to.width = from.info.width;
  to.height = from.info.height;
  to.cells = from.data;
  if (from.data.size() != std::size_t{to.width} * to.height)
    return "the map has another number of cells than it says";
  return std::abs(yaw(rotation(from.info.origin.orientation))) < kStraight
             ? nullptr
             : "the map is turned, which is not supported";
}

Problem convert(const nav_msgs::Path& from, messages::Path& to, const Names&) {
  to.poses.resize(from.poses.size());
  for (std::size_t i = 0; i < from.poses.size(); ++i)
    to.poses[i] = pose_in_plane(from.poses[i].pose);
  to.goal = to.poses.empty() ? messages::Pose2D() : to.poses.back();
  return nullptr;
}

Problem convert(const sensor_msgs::Image& from, messages::Image& to, const Names&) {
  constexpr std::size_t kBytes = 3;  // of a pixel
  const bool reversed = from.encoding == "bgr8";
  if (!reversed && from.encoding != "rgb8") return "the image is neither rgb8 nor bgr8";
  const std::size_t row = kBytes * from.width;
  if (from.step < row || from.data.size() != std::size_t{from.step} * from.height)
    return "the image has another number of bytes than pixels";
  to.time = seconds(from.header.stamp);
  to.width = from.width;
  to.height = from.height;
  to.rgb.resize(row * from.height);
  for (std::size_t y = 0; y < from.height; ++y)
    std::copy_n(from.data.begin() + static_cast<std::ptrdiff_t>(y * from.step), row,
                to.rgb.begin() + static_cast<std::ptrdiff_t>(y * row));
  for (std::size_t i = 0; reversed && i < to.rgb.size(); i += kBytes)
    std::swap(to.rgb[i], to.rgb[i + 2]);
  return nullptr;
}

Problem convert(const rosgraph_msgs::Clock& from, double& time, const Names&) {
  time = seconds(from.clock);
  return nullptr;
}

}  // namespace ros2_messages
