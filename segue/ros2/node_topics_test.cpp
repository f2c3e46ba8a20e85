// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/node_topics.hpp>

#include <segue/type/yaml.hpp>

#include <gmock/gmock.h>

namespace segue::ros2 {
namespace {

using Rules = std::vector<std::string>;

std::string resolved(const std::string& topic, const Rules& rules = {}) {
  const auto done = resolve_topic(topic, "/robot/lidar", rules);
  return done ? *done : "refused: " + to_string(done.error());
}

TEST(NodeTopics, AreInTheNamespaceOfTheirNode) {
  EXPECT_EQ(resolved("/scan"), "/scan");
  EXPECT_EQ(resolved("scan"), "/robot/scan");
  EXPECT_EQ(resolved("~/scan"), "/robot/lidar/scan");
  EXPECT_EQ(resolve_topic("scan", "/lidar", {}).value(), "/scan");
  EXPECT_EQ(resolve_topic("~/scan", "/lidar", {}).value(), "/lidar/scan");
}

TEST(NodeTopics, FollowTheFirstRemappingThatFits) {
  EXPECT_EQ(resolved("scan", {"points:=/x", "scan:=/front/scan", "scan:=/y"}), "/front/scan");
  EXPECT_EQ(resolved("/robot/scan", {"scan:=points"}), "/robot/points");
  EXPECT_EQ(resolved("scan", {"/robot/scan:=~/scan"}), "/robot/lidar/scan");
  EXPECT_EQ(resolved("/scan", {"scan:=/x"}), "/scan") << "/robot/scan is another one";
}

TEST(NodeTopics, FollowOnlyRemappingsOfTopicsOfTheirNode) {
  EXPECT_EQ(resolved("scan", {"slam:scan:=/x", "lidar:scan:=/y"}), "/y");
  EXPECT_EQ(resolved("scan", {"rosservice://scan:=/x", "rostopic://scan:=rostopic://y"}), "/robot/y");
  EXPECT_EQ(resolved("scan", {"lidar:rostopic://scan:=/z"}), "/z");
  EXPECT_EQ(resolved("scan", {"__node:=other", "scan"}), "/robot/scan");
}

TEST(NodeTopics, ThatAreNoNamesAreRefused) {
  EXPECT_THAT(resolved("a b"), ::testing::HasSubstr("'/robot/a b' is not a valid name of a topic"));
  EXPECT_THAT(resolved("", {}), ::testing::HasSubstr("refused"));
  EXPECT_THAT(resolved("~scan"), ::testing::HasSubstr("refused"));
}

TEST(NodeTopics, OfATaskComeFromItsProperties) {
  const auto properties = type::parse_yaml(
      "name: /robot/lidar\n"
      "process: {package: p, executable: e, remappings: ['scan:=/front']}\n"
      "publishes: {scan: sensor_msgs/msg/LaserScan, wrong: {topic: /x}}\n"
      "subscribes: {command: {topic: /cmd_vel, type: geometry_msgs/msg/Twist}, worse: 3}\n");
  ASSERT_TRUE(properties);
  const auto topics = topics_of_task(*properties);
  ASSERT_EQ(topics.size(), 2U);
  EXPECT_EQ(topics[0].port + " " + topics[0].topic + " " + topics[0].type,
            "scan /front sensor_msgs/msg/LaserScan");
  EXPECT_TRUE(topics[0].is_published);
  EXPECT_EQ(topics[1].port + " " + topics[1].topic, "command /cmd_vel");
  EXPECT_FALSE(topics[1].is_published);
  EXPECT_TRUE(topics_of_task(type::Value(3)).empty());
}

}  // namespace
}  // namespace segue::ros2
