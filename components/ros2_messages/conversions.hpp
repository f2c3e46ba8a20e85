// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../messages/geometry.hpp"
#include "../messages/sensors.hpp"

#include <geometry_msgs/msg/pose_stamped.hpp>
#include <geometry_msgs/msg/twist.hpp>
#include <nav_msgs/msg/occupancy_grid.hpp>
#include <nav_msgs/msg/odometry.hpp>
#include <nav_msgs/msg/path.hpp>
#include <rosgraph_msgs/msg/clock.hpp>
#include <sensor_msgs/msg/image.hpp>
#include <sensor_msgs/msg/imu.hpp>
#include <sensor_msgs/msg/joint_state.hpp>
#include <sensor_msgs/msg/laser_scan.hpp>
#include <tf2_msgs/msg/tf_message.hpp>

#include <string>
#include <vector>

/// Messages of Segue's components (components/messages) as those of ROS 2, and the reverse. Both have metres,
/// radians, seconds, and x forward (REP-103), so that only the form differs. Nothing allocates where the
/// result has the room.
namespace ros2_messages {

/// Names that Segue's messages do not have.
struct Names {
  std::string frame;                ///< of the header
  std::string child;                ///< of a body that moves in it
  std::vector<std::string> joints;  ///< in the order of their driver
};

/// nullptr, or why there is no such message: a static text. `to` is only partly set then.
using Problem = const char*;

Problem convert(const messages::LaserScan& from, sensor_msgs::LaserScan& to, const Names& names);
/// Without covariances, which Segue does not know: zero, as ROS 2 has it for unknown.
Problem convert(const messages::Imu& from, sensor_msgs::Imu& to, const Names& names);
Problem convert(const messages::Image& from, sensor_msgs::Image& to, const Names& names);
/// Refused where there are other numbers of names and positions.
Problem convert(const messages::JointState& from, sensor_msgs::JointState& to, const Names& names);
Problem convert(const messages::Odometry& from, nav_msgs::Odometry& to, const Names& names);
/// The transform from the frame to the child, for /tf.
Problem convert(const messages::Odometry& from, tf2_msgs::TFMessage& to, const Names& names);
Problem convert(const messages::TimedPose& from, tf2_msgs::TFMessage& to, const Names& names);
Problem convert(const messages::OccupancyGrid& from, nav_msgs::OccupancyGrid& to, const Names& names);
Problem convert(const messages::Path& from, nav_msgs::Path& to, const Names& names);
Problem convert(const messages::Twist2D& from, geometry_msgs::Twist& to, const Names& names);
/// Without a time, which Segue does not know: zero, which those who look up transforms take for the latest.
Problem convert(const messages::Pose2D& from, geometry_msgs::PoseStamped& to, const Names& names);
Problem convert(const double& time, rosgraph_msgs::Clock& to, const Names& names);

Problem convert(const sensor_msgs::LaserScan& from, messages::LaserScan& to, const Names& names);
Problem convert(const sensor_msgs::Imu& from, messages::Imu& to, const Names& names);
/// In the order of `joints`, where these are given: others are left out, and none may be missing.
Problem convert(const sensor_msgs::JointState& from, messages::JointState& to, const Names& names);
/// In the plane: what goes beyond is left out.
Problem convert(const nav_msgs::Odometry& from, messages::Odometry& to, const Names& names);
Problem convert(const geometry_msgs::Twist& from, messages::Twist2D& to, const Names& names);
Problem convert(const geometry_msgs::PoseStamped& from, messages::Pose2D& to, const Names& names);
/// Refused where its rows do not lie along the x axis, or where it has other numbers of cells than it says.
Problem convert(const nav_msgs::OccupancyGrid& from, messages::OccupancyGrid& to, const Names& names);
/// The goal is the last pose.
Problem convert(const nav_msgs::Path& from, messages::Path& to, const Names& names);
/// Refused unless its encoding is rgb8 or bgr8, and where it has other numbers of bytes than it says.
Problem convert(const sensor_msgs::Image& from, messages::Image& to, const Names& names);
Problem convert(const rosgraph_msgs::Clock& from, double& time, const Names& names);

}  // namespace ros2_messages
