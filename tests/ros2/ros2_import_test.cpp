// SPDX-License-Identifier: Apache-2.0
// A system of ROS 2 that runs is looked at, and becomes a robot, through the real command line.
#include <support/dds_domain.hpp>

#include <gmock/gmock.h>

#include "../../components/ros2/peers/node_peer.hpp"
#include "../system/system_test.hpp"

#include <unistd.h>

#include <algorithm>
#include <sstream>
#include <string>

namespace segue::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::uint32_t domain_of_test() {
  return segue::testing::dds_domain_of_process();
}

class RunningRos2 : public SystemTest {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    ::setenv("ROS_DOMAIN_ID", std::to_string(domain_of_test()).c_str(), 1);
    ::setenv("ROS_LOCALHOST_ONLY", "1", 1);
  }
  [[nodiscard]] std::string read(const std::string& file) const {
    return (std::ostringstream() << std::ifstream(folder_ / file).rdbuf()).str();
  }

  ::ros2::testing::NodePeer peer{::ros2::testing::fast_peers_of_one_node(domain_of_test())};
};

TEST_F(RunningRos2, IsListed) {
  // Another process has to find the nodes anew, which takes what it takes on a loaded machine.
  std::string topics;
  EXPECT_TRUE(eventually([&] {
    topics = segue({"ros2", "topics", "--wait", "2s"}).output;
    return ::testing::Value(topics, ::testing::ContainsRegex("/scan +lidar_msgs/msg/Sweep +/lidar"));
  })) << topics;
  EXPECT_TRUE(eventually([&] {
    return segue({"ros2", "nodes", "--wait", "2s"}).output.find("yes") != std::string::npos;
  }));
  const auto other = segue({"ros2", "nodes", "--wait", "1s", "--domain", "232"});
  EXPECT_EQ(other.status, 0) << other.errors;
  EXPECT_THAT(other.output, Not(HasSubstr("/lidar"))) << "it is in another domain";
}

TEST_F(RunningRos2, SaysBetweenWhichNodesNoSamplesTravel) {
  const auto listener = ::ros2::testing::make_fast_peer(domain_of_test());
  listener->subscribe({.topic = "/scan", .interface = "std_msgs/msg/String"});
  listener->announce("listener");
  std::string topics;
  EXPECT_TRUE(eventually([&] {
    topics = segue({"ros2", "topics", "--wait", "2s"}).output;
    return topics.find(
               "\n/scan: /listener gets nothing from /lidar: type: lidar_msgs/msg/Sweep is offered, "
               "std_msgs/msg/String is requested") != std::string::npos;
  })) << topics;
}

TEST_F(RunningRos2, IsKnownToCompletion) {
  for (const auto& [kind, name] : {std::pair{"ros2-nodes", "/lidar\n"}, {"ros2-topics", "/scan\n"}}) {
    EXPECT_TRUE(eventually([&] {
      return segue({"complete-names", kind}).output.find(name) != std::string::npos;
    })) << kind;
  }
  ::setenv("ROS_DOMAIN_ID", "no number", 1);
  for (const char* kind : {"ros2-nodes", "ros2-topics"}) {
    const auto failed = segue({"complete-names", kind});
    EXPECT_EQ(failed.status, 0);
    EXPECT_EQ(failed.output + failed.errors, "") << "shells show what it says";
  }
}

TEST_F(RunningRos2, HasTopicsThatCanBeNamed) {
  std::string topics;
  EXPECT_TRUE(eventually([&] {
    topics = segue({"ros2", "topics", "/scan", "--wait", "2s"}).output;
    return topics.find("/lidar") != std::string::npos;
  })) << topics;
  EXPECT_EQ(std::ranges::count(topics, '\n'), 2) << "the heading and the topic: " << topics;
  EXPECT_THAT(segue({"ros2", "topics", "/scam", "--wait", "2s"}).errors, HasSubstr("no topic '/scam'"));
}

TEST_F(RunningRos2, IsDescribedWithItsTypes) {
  const auto shown =
      segue({"ros2", "describe", "/lidar", "--wait", "100s", "--timeout", "100s", "--types", "types"});
  ASSERT_EQ(shown.status, 0) << shown.errors;
  EXPECT_THAT(shown.output, HasSubstr("/lidar (managed, active)\n"));
  EXPECT_THAT(shown.output, ::testing::ContainsRegex("/scan +lidar_msgs/msg/Sweep +best_effort, volatile"));
  EXPECT_THAT(shown.output, ::testing::ContainsRegex("rate +10 +integer +1 to 40, step 1 +scans a second"));
  EXPECT_THAT(shown.output, ::testing::ContainsRegex("serial +A-17 +string +read-only"));
  EXPECT_THAT(shown.errors, HasSubstr("wrote 1 file to types"));
  EXPECT_THAT(segue({"ros2", "interface", "lidar_msgs/msg/Sweep", "--interfaces", "types"}).output,
              HasSubstr("hash: " + peer.hash()));
  // A task of the network is what the node is, and fits it.
  const auto task =
      segue({"ros2", "describe", "/lidar", "--wait", "100s", "--timeout", "100s", "--model", "lidar.yaml"});
  EXPECT_EQ(task.status, 0) << task.errors;
  EXPECT_THAT(read("lidar.yaml"), HasSubstr("publishes:"));
  EXPECT_THAT(read("lidar.yaml"), HasSubstr("lidar_msgs/msg/Sweep"));
  EXPECT_EQ(segue({"check", "lidar.yaml", "--structure"}).status, 0);
  const auto nobody = segue({"ros2", "describe", "/lidr", "--wait", "1s"});
  EXPECT_EQ(nobody.status, 1);
  EXPECT_THAT(nobody.errors, HasSubstr("no node '/lidr'"));
}

/// The nodes go on running, and the robot drives them.
TEST_F(RunningRos2, BecomesARobot) {
  int tries = 0;
  std::string folder;
  std::string said;
  ASSERT_TRUE(eventually([&] {
    folder = "robot" + std::to_string(++tries);
    const auto done = segue({"import", "ros2", folder, "--name", "rover", "--timeout", "100s", "--running"});
    said += done.output + done.errors;
    return done.status == 0 &&
           read(folder + "/controllers/nodes.yaml").find("filter.gain") != std::string::npos;
  })) << said;
  std::string network = read(folder + "/controllers/nodes.yaml");
  EXPECT_THAT(network, HasSubstr("#   /scan (lidar_msgs/msg/Sweep): /lidar -> (nobody)\n"));
  EXPECT_THAT(network, HasSubstr("# parameters that cannot be set: serial\n"));
  EXPECT_EQ(segue({"import", "ros2", folder}).status, 1) << "the folder is not empty";
  const std::string name = "      name: /lidar\n";
  ASSERT_NE(network.find(name), std::string::npos) << network;
  write(folder + "/controllers/nodes.yaml", network.insert(network.find(name), "      timeout: 100s\n"));
  const auto checked = segue({"check", folder + "/robot.yaml"});
  EXPECT_EQ(checked.status, 0) << checked.output << checked.errors;
  robot_ =
      std::make_unique<Process>(command({"run", folder + "/robot.yaml", "--controller", "nodes"}), folder_);
  ASSERT_TRUE(robot_->wait_for("robot rover runs")) << robot_->wait().errors;
  ASSERT_TRUE(eventually([&] { return controller() == "nodes"; }));
  EXPECT_EQ(peer.state(), 3);
  const type::Value got = peer.got_parameters();
  EXPECT_EQ(got, type::Value::map({{"frame", "lidar_link"},
                                   {"rate", 10},
                                   {"filter.gain", 2.0},
                                   {"offsets", type::Value::list({0.5, 1.0})}}));
  EXPECT_EQ(stop().status, 0);
}

}  // namespace
}  // namespace segue::testing
