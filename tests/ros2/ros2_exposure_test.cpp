// SPDX-License-Identifier: Apache-2.0
// The tasks of a robot are seen as nodes of ROS 2, through the real command line.
#include <support/dds_domain.hpp>

#include <gmock/gmock.h>

#include "../system/system_test.hpp"

#include <unistd.h>

#include <string>
#include <utility>
#include <vector>

namespace segue::testing {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using type::Value;

class RobotForRos2 : public SystemTest {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    ::setenv("ROS_DOMAIN_ID", std::to_string(dds_domain_of_process()).c_str(), 1);
    ::setenv("ROS_LOCALHOST_ONLY", "1", 1);
    write("rover/robot.yaml",
          "robot: rover\nlibraries: [segue_components_ros2, segue_components_demo]\n"
          "controllers: [controllers/*.yaml]\n");
    write("rover/controllers/drive.yaml", network({{"drive", "Drive"}}));
    write("rover/controllers/steer.yaml", network({{"drive", "Drive"}, {"joystick", "Joystick"}}));
    write("rover/controllers/rest.yaml", network({{"joystick", "Joystick"}}));
    start({"--controller", "drive"});
    ASSERT_NO_FATAL_FAILURE(wait_for_controller("drive"));
  }
  /// Tasks of the demo and what exposes them, in two processes, which outlive the robot.
  static std::string network(const std::vector<std::pair<std::string, std::string>>& all) {
    std::string tasks;
    std::string names;
    for (const auto& [name, component] : all) {
      tasks += "  " + name + ": {component: demo::" + component + "}\n";
      names += (names.empty() ? "" : ", ") + name;
    }
    return "tasks:\n  exposure: {component: 'ros2::Exposure', properties: {namespace: /rover, writable: "
           "true}}\n" +
           tasks + "deployments: {ros2: {tasks: [exposure]}, demo: {tasks: [" + names + "]}}\n";
  }
  Finished describe(const std::string& node) {
    return segue({"ros2", "describe", node, "--wait", "100s", "--timeout", "100s"});
  }
  /// Whether others see that node now.
  bool is_node(const std::string& node) {
    const Value nodes = json({"ros2", "nodes", "--wait", "2s"});
    return std::ranges::any_of(nodes.as_list(),
                               [&](const Value& one) { return *one.find("name") == Value(node); });
  }
};

TEST_F(RobotForRos2, IsDescribedWithPropertiesAndStates) {
  const auto shown = describe("/rover/drive");
  ASSERT_EQ(shown.status, 0) << shown.errors;
  EXPECT_THAT(shown.output, HasSubstr("/rover/drive (managed, active)\n"));
  EXPECT_THAT(shown.output, ContainsRegex("max_speed +0.8 +double +m/s"));
  EXPECT_THAT(shown.output, ContainsRegex("max_acceleration +2.* +double +read-only +m/s"));
  ASSERT_EQ(segue({"set", "drive.max_speed=0.4"}).status, 0);
  EXPECT_THAT(describe("/rover/drive").output, ContainsRegex("max_speed +0.4 +double"));
}

TEST_F(RobotForRos2, IsFollowedThroughSwitches) {
  ASSERT_EQ(segue({"switch", "steer"}).status, 0);
  EXPECT_THAT(describe("/rover/joystick").output, HasSubstr("/rover/joystick (managed, active)\n"));
  ASSERT_EQ(segue({"switch", "rest"}).status, 0);
  EXPECT_TRUE(eventually([&] { return !is_node("/rover/drive"); }));
  EXPECT_TRUE(is_node("/rover/joystick"));
}

TEST_F(RobotForRos2, IsNotSeenAfterItsEnd) {
  ASSERT_THAT(describe("/rover/drive").output, HasSubstr("active"));
  robot_->signal(SIGKILL);
  robot_->wait();
  EXPECT_TRUE(eventually([&] { return is_node("/exposure") && !is_node("/rover/drive"); }));
  robot_.reset();
  start();
  EXPECT_THAT(describe("/rover/drive").output, HasSubstr("active")) << "it is connected again";
}

/// A driver of nodes, such as another robot, gets parameters set, but no states changed.
TEST_F(RobotForRos2, HasItsPropertiesSetButNotItsStates) {
  write("other/robot.yaml",
        "robot: other\nlibraries: [segue_components_ros2]\ncontrollers: [controllers/*.yaml]\n");
  const auto driver = [](const std::string& component, const std::string& parameters) {
    return "tasks:\n  proxy: {component: 'ros2::" + component +
           "', properties: {name: /rover/drive, timeout: 100s, parameters: {" + parameters +
           "}}}\ndeployments: {ros2: {tasks: [proxy]}}\n";
  };
  write("other/controllers/idle.yaml", "tasks: {}\n");
  write("other/controllers/set.yaml", driver("Node", "max_speed: 0.3"));
  write("other/controllers/refused.yaml", driver("Node", "max_acceleration: 0.3"));
  write("other/controllers/managed.yaml", driver("ManagedNode", ""));
  Process other(command({"run", "other/robot.yaml", "--controller", "idle"}), folder_);
  ASSERT_TRUE(other.wait_for("robot other runs")) << other.wait().errors;
  const auto set = segue({"switch", "set", "--robot", "other", "--timeout", "200s"});
  EXPECT_EQ(set.status, 0) << set.output << set.errors;
  EXPECT_THAT(segue({"task", "drive", "--robot", "rover"}).output, HasSubstr("max_speed: 0.3"));
  ASSERT_EQ(segue({"set", "drive.max_speed=0.9", "--robot", "rover"}).status, 0);
  EXPECT_TRUE(eventually([&] {
    return segue({"call", "proxy.changed_parameters", "--robot", "other"}).output.find("is 0.9, not 0.3") !=
           std::string::npos;
  })) << "the driver is told";
  // While somebody else commands the robot, nothing is set beside that.
  write(
      "hold.yaml",
      "mission: hold\nactions:\n  hold: {run: {controller: drive, until: [{after: 30min}]}}\naction: hold\n");
  Process mission(command({"mission", "run", "hold.yaml", "--robot", "rover"}), folder_);
  ASSERT_TRUE(eventually([&] {
    return json({"status", "--robot", "rover"}).find("commanded_by")->is_string();
  }));
  const auto beside = segue({"switch", "set", "--set", "proxy.parameters={max_speed: 0.2}", "--robot",
                             "other", "--timeout", "200s"});
  EXPECT_NE(beside.status, 0);
  EXPECT_THAT(beside.output + beside.errors, HasSubstr("the robot is commanded by segue mission run"));
  EXPECT_THAT(segue({"task", "drive", "--robot", "rover"}).output, Not(HasSubstr("max_speed: 0.2")));
  mission.signal(SIGINT);
  mission.wait();
  const auto refused = segue({"switch", "refused", "--robot", "other", "--timeout", "200s"});
  EXPECT_NE(refused.status, 0);
  EXPECT_THAT(refused.output + refused.errors, HasSubstr("drive.max_acceleration is read when the task is"));
  const auto managed = segue({"switch", "managed", "--robot", "other", "--timeout", "200s"});
  EXPECT_NE(managed.status, 0) << "the controller of rover decides";
  EXPECT_THAT(describe("/rover/drive").output, HasSubstr("active"));
  other.signal(SIGINT);
  EXPECT_EQ(other.wait().status, 0);
}

}  // namespace
}  // namespace segue::testing
