// SPDX-License-Identifier: Apache-2.0
#include "converter.hpp"

/// Messages of ROS 2 as those of Segue's components.
namespace from_ros2 {

using namespace ros2_messages;  // NOLINT(google-build-using-namespace)

class LaserScan final : public Converter<sensor_msgs::LaserScan, messages::LaserScan> {
 public:
  LaserScan() : Converter("A laser scan from sensor_msgs/msg/LaserScan", 4096) {}
};

class Imu final : public Converter<sensor_msgs::Imu, messages::Imu> {
 public:
  Imu() : Converter("An IMU from sensor_msgs/msg/Imu", 0) {}
};

class OccupancyGrid final : public Converter<nav_msgs::OccupancyGrid, messages::OccupancyGrid> {
 public:
  OccupancyGrid() : Converter("A map from nav_msgs/msg/OccupancyGrid", 4'000'000) {}
};

class Odometry final : public Converter<nav_msgs::Odometry, messages::Odometry> {
 public:
  Odometry() : Converter("Odometry from nav_msgs/msg/Odometry", 0) {}
};

class JointState final : public JointConverter<sensor_msgs::JointState, messages::JointState> {
 public:
  JointState() : JointConverter("Joints from sensor_msgs/msg/JointState") {}
};

class Path final : public Converter<nav_msgs::Path, messages::Path> {
 public:
  Path() : Converter("A path from nav_msgs/msg/Path", 4096) {}
};

class Image final : public Converter<sensor_msgs::Image, messages::Image> {
 public:
  Image() : Converter("A colour image from sensor_msgs/msg/Image", 3 * 1920 * 1080) {}
};

class Twist final : public Converter<geometry_msgs::Twist, messages::Twist2D> {
 public:
  Twist() : Converter("A velocity from geometry_msgs/msg/Twist, such as /cmd_vel", 0) {}
};

class Pose final : public Converter<geometry_msgs::PoseStamped, messages::Pose2D> {
 public:
  Pose() : Converter("A pose in the plane from geometry_msgs/msg/PoseStamped, such as /goal_pose", 0) {}
};

class Clock final : public Converter<rosgraph_msgs::Clock, double> {
 public:
  Clock() : Converter("A time in seconds from rosgraph_msgs/msg/Clock", 0) {}
};

}  // namespace from_ros2

SEGUE_COMPONENT(from_ros2::LaserScan)
SEGUE_COMPONENT(from_ros2::Imu)
SEGUE_COMPONENT(from_ros2::OccupancyGrid)
SEGUE_COMPONENT(from_ros2::Odometry)
SEGUE_COMPONENT(from_ros2::JointState)
SEGUE_COMPONENT(from_ros2::Path)
SEGUE_COMPONENT(from_ros2::Image)
SEGUE_COMPONENT(from_ros2::Twist)
SEGUE_COMPONENT(from_ros2::Pose)
SEGUE_COMPONENT(from_ros2::Clock)
