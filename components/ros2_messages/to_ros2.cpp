// SPDX-License-Identifier: Apache-2.0
#include "converter.hpp"

/// Messages of Segue's components as those of ROS 2.
namespace to_ros2 {

using namespace ros2_messages;  // NOLINT(google-build-using-namespace)

constexpr std::uint32_t kRanges = 4096;
constexpr std::uint32_t kCells = 4'000'000;
constexpr std::uint32_t kPoses = 4096;
constexpr std::uint32_t kBytes = 3 * 1920 * 1080;

class LaserScan final : public FramedConverter<messages::LaserScan, sensor_msgs::LaserScan> {
 public:
  LaserScan() : FramedConverter("A laser scan as sensor_msgs/msg/LaserScan", kRanges, "laser") {}
};

class Imu final : public FramedConverter<messages::Imu, sensor_msgs::Imu> {
 public:
  Imu() : FramedConverter("An IMU as sensor_msgs/msg/Imu", 0, "imu") {}
};

class Image final : public FramedConverter<messages::Image, sensor_msgs::Image> {
 public:
  Image() : FramedConverter("An image as sensor_msgs/msg/Image", kBytes, "camera") {}
};

class OccupancyGrid final : public FramedConverter<messages::OccupancyGrid, nav_msgs::OccupancyGrid> {
 public:
  OccupancyGrid() : FramedConverter("A map as nav_msgs/msg/OccupancyGrid", kCells, "map") {}
};

class Path final : public FramedConverter<messages::Path, nav_msgs::Path> {
 public:
  Path() : FramedConverter("A path as nav_msgs/msg/Path", kPoses, "map") {}
};

class Twist final : public Converter<messages::Twist2D, geometry_msgs::Twist> {
 public:
  Twist() : Converter("A velocity as geometry_msgs/msg/Twist, such as for /cmd_vel", 0) {}
};

class Pose final : public FramedConverter<messages::Pose2D, geometry_msgs::PoseStamped> {
 public:
  Pose()
      : FramedConverter("A pose in the plane as geometry_msgs/msg/PoseStamped, such as for /goal_pose", 0,
                        "map") {}
};

class Odometry final : public MovingConverter<messages::Odometry, nav_msgs::Odometry> {
 public:
  Odometry() : MovingConverter("Odometry as nav_msgs/msg/Odometry") {}
};

class Transform final : public MovingConverter<messages::Odometry, tf2_msgs::TFMessage> {
 public:
  Transform() : MovingConverter("Odometry as a transform, tf2_msgs/msg/TFMessage, for /tf") {}
};

class PoseTransform final : public MovingConverter<messages::TimedPose, tf2_msgs::TFMessage> {
 public:
  PoseTransform() : MovingConverter("A pose as a transform, tf2_msgs/msg/TFMessage, for /tf") {}
};

class JointState final : public JointConverter<messages::JointState, sensor_msgs::JointState> {
 public:
  JointState() : JointConverter("Joints as sensor_msgs/msg/JointState") {}
};

class Clock final : public Converter<double, rosgraph_msgs::Clock> {
 public:
  Clock() : Converter("A time in seconds as rosgraph_msgs/msg/Clock, for /clock", 0) {}
};

}  // namespace to_ros2

SEGUE_COMPONENT(to_ros2::LaserScan)
SEGUE_COMPONENT(to_ros2::Imu)
SEGUE_COMPONENT(to_ros2::Image)
SEGUE_COMPONENT(to_ros2::OccupancyGrid)
SEGUE_COMPONENT(to_ros2::Path)
SEGUE_COMPONENT(to_ros2::Twist)
SEGUE_COMPONENT(to_ros2::Pose)
SEGUE_COMPONENT(to_ros2::Odometry)
SEGUE_COMPONENT(to_ros2::Transform)
SEGUE_COMPONENT(to_ros2::PoseTransform)
SEGUE_COMPONENT(to_ros2::JointState)
SEGUE_COMPONENT(to_ros2::Clock)
