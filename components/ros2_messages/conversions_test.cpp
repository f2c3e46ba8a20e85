// SPDX-License-Identifier: Apache-2.0
#include "conversions.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace ros2_messages {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const Names kNames = {"map", "base_link", {"shoulder", "elbow"}};

TEST(Conversions, OfScansKeepAnglesAndRanges) {
  const messages::LaserScan scan{12.25, -1.5, 0.5, 0.1, 30, {1, 2, 3}};
  sensor_msgs::LaserScan sent;
  ASSERT_EQ(convert(scan, sent, kNames), nullptr);
  EXPECT_EQ(sent.header.frame_id, "map");
  EXPECT_EQ(sent.header.stamp.sec, 12);
  EXPECT_EQ(sent.header.stamp.nanosec, 250'000'000U);
  EXPECT_EQ(sent.angle_max, -0.5F);
  messages::LaserScan back;
  ASSERT_EQ(convert(sent, back, kNames), nullptr);
  EXPECT_EQ(back.time, scan.time);
  EXPECT_EQ(back.first_angle, scan.first_angle);
  EXPECT_EQ(back.angle_step, scan.angle_step);
  EXPECT_EQ(back.ranges, scan.ranges);
}

TEST(Conversions, OfTimesThatRos2CannotTellGiveTheNearest) {
  const auto stamp = [](double time) {
    rosgraph_msgs::Clock clock;
    EXPECT_EQ(convert(time, clock, kNames), nullptr);
    return std::pair(clock.clock.sec, clock.clock.nanosec);
  };
  EXPECT_EQ(stamp(-3), std::pair(0, 0U));
  EXPECT_EQ(stamp(std::nan("")), std::pair(0, 0U));
  EXPECT_EQ(stamp(1e300).first, std::numeric_limits<std::int32_t>::max());
  EXPECT_EQ(stamp(0.9999999999), std::pair(0, 999'999'999U)) << "never a whole second of nanoseconds";
}

TEST(Conversions, OfMapsKeepCellsAndCorner) {
  const messages::OccupancyGrid map{3, 0.5, -1, -2, 2, 2, {0, 100, -1, 50}};
  nav_msgs::OccupancyGrid sent;
  ASSERT_EQ(convert(map, sent, kNames), nullptr);
  EXPECT_EQ(sent.info.origin.position.y, -2);
  EXPECT_EQ(sent.info.origin.orientation.w, 1);
  messages::OccupancyGrid back;
  ASSERT_EQ(convert(sent, back, kNames), nullptr);
  EXPECT_EQ(back.cells, map.cells);
  EXPECT_EQ(back.x, -1);
  sent.info.width = 3;
  EXPECT_THAT(convert(sent, back, kNames), HasSubstr("another number of cells"));
  sent.info.width = 2;
  sent.info.origin.orientation = {0, 0, std::sqrt(0.5), std::sqrt(0.5)};
  EXPECT_THAT(convert(sent, back, kNames), HasSubstr("the map is turned"));
}

TEST(Conversions, OfOdometryKeepThePlane) {
  const messages::Odometry odometry{1, {2, 3, -2.5}, {0.5, -0.25}};
  nav_msgs::Odometry sent;
  ASSERT_EQ(convert(odometry, sent, kNames), nullptr);
  EXPECT_EQ(sent.child_frame_id, "base_link");
  messages::Odometry back;
  ASSERT_EQ(convert(sent, back, kNames), nullptr);
  EXPECT_NEAR(back.pose.theta, -2.5, 1e-12);
  EXPECT_EQ(back.twist.angular, -0.25);
  tf2_msgs::TFMessage transform;
  ASSERT_EQ(convert(odometry, transform, kNames), nullptr);
  EXPECT_EQ(transform.transforms.front().child_frame_id, "base_link");
  EXPECT_EQ(transform.transforms.front().transform.translation.y, 3);
  EXPECT_NEAR(transform.transforms.front().transform.rotation.z, std::sin(-1.25), 1e-12);
}

TEST(Conversions, OfJointsFollowTheirNames) {
  sensor_msgs::JointState sent;
  ASSERT_EQ(convert(messages::JointState{1, {0.1, 0.2}, {}, {}}, sent, kNames), nullptr);
  EXPECT_THAT(sent.name, ElementsAre("shoulder", "elbow"));
  sent = {};
  sent.name = {"elbow", "wrist", "shoulder"};
  sent.position = {2, 3, 1};
  messages::JointState back;
  ASSERT_EQ(convert(sent, back, kNames), nullptr);
  EXPECT_THAT(back.positions, ElementsAre(1, 2)) << "in the order of the driver";
  sent.position.pop_back();
  EXPECT_THAT(convert(sent, back, kNames), HasSubstr("some joints have a value"));
  sent.name = {"elbow"};
  EXPECT_THAT(convert(sent, back, kNames), HasSubstr("is missing"));
  EXPECT_THAT(convert(messages::JointState{1, {0.1}, {}, {}}, sent, kNames),
              HasSubstr("another number of joints"));
}

TEST(Conversions, OfImagesPathsAndImus) {
  sensor_msgs::Image image;
  EXPECT_EQ(convert(messages::Image{1, 1, 2, {1, 2, 3, 4, 5, 6}}, image, kNames), nullptr);
  EXPECT_EQ(image.step, 3U);
  EXPECT_THAT(convert(messages::Image{1, 2, 2, {1}}, image, kNames), HasSubstr("another number of bytes"));
  nav_msgs::Path path;
  ASSERT_EQ(convert(messages::Path{{}, {{1, 2, 0}, {3, 4, 1}}}, path, kNames), nullptr);
  messages::Pose2D pose;
  ASSERT_EQ(convert(path.poses.back(), pose, kNames), nullptr);
  EXPECT_NEAR(pose.theta, 1, 1e-12);
  messages::Path passed;
  ASSERT_EQ(convert(path, passed, kNames), nullptr);
  ASSERT_EQ(passed.poses.size(), 2U);
  EXPECT_EQ(passed.poses.front().y, 2);
  EXPECT_EQ(passed.goal.x, 3);
  ASSERT_EQ(convert(nav_msgs::Path{}, passed, kNames), nullptr);
  EXPECT_TRUE(passed.poses.empty());
  messages::Imu imu;
  imu.orientation = Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5);
  imu.linear_acceleration = {1, 2, 9.81};
  sensor_msgs::Imu sent;
  ASSERT_EQ(convert(imu, sent, kNames), nullptr);
  messages::Imu back;
  ASSERT_EQ(convert(sent, back, kNames), nullptr);
  EXPECT_EQ(back.linear_acceleration, imu.linear_acceleration);
  EXPECT_EQ(back.orientation.coeffs(), imu.orientation.coeffs());
}

TEST(Conversions, OfImagesTakeBothOrdersOfColoursAndFilledRows) {
  sensor_msgs::Image sent;
  ASSERT_EQ(convert(messages::Image{1.5, 1, 2, {1, 2, 3, 4, 5, 6}}, sent, kNames), nullptr);
  messages::Image back;
  ASSERT_EQ(convert(sent, back, kNames), nullptr);
  EXPECT_EQ(back.time, 1.5);
  EXPECT_THAT(back.rgb, ElementsAre(1, 2, 3, 4, 5, 6));
  sent.encoding = "bgr8";
  sent.step = 4;
  sent.data = {1, 2, 3, 0, 4, 5, 6, 0};
  ASSERT_EQ(convert(sent, back, kNames), nullptr);
  EXPECT_THAT(back.rgb, ElementsAre(3, 2, 1, 6, 5, 4));
  sent.data.pop_back();
  EXPECT_THAT(convert(sent, back, kNames), HasSubstr("another number of bytes"));
  sent.encoding = "mono8";
  EXPECT_THAT(convert(sent, back, kNames), HasSubstr("neither rgb8 nor bgr8"));
}

TEST(Conversions, OfCommandsKeepVelocitiesAndGoals) {
  geometry_msgs::Twist twist;
  ASSERT_EQ(convert(messages::Twist2D{0.5, -1}, twist, kNames), nullptr);
  EXPECT_EQ(twist.linear.x, 0.5);
  EXPECT_EQ(twist.linear.y, 0);
  EXPECT_EQ(twist.angular.z, -1);
  messages::Twist2D velocity;
  ASSERT_EQ(convert(twist, velocity, kNames), nullptr);
  EXPECT_EQ(velocity.angular, -1);
  geometry_msgs::PoseStamped goal;
  goal.header.stamp.sec = 5;
  ASSERT_EQ(convert(messages::Pose2D{1, 2, 3}, goal, kNames), nullptr);
  EXPECT_EQ(goal.header.frame_id, "map");
  EXPECT_EQ(goal.header.stamp.sec, 0);
  messages::Pose2D pose;
  ASSERT_EQ(convert(goal, pose, kNames), nullptr);
  EXPECT_EQ(pose.y, 2);
  EXPECT_NEAR(pose.theta, 3, 1e-12);
}

}  // namespace
}  // namespace ros2_messages
