// SPDX-License-Identifier: Apache-2.0
// Nodes of ROS 2 that a robot starts, through the real command line.
#include <support/dds_domain.hpp>
#include <support/ros2_installation.hpp>

#include <gmock/gmock.h>

#include "../system/system_test.hpp"

#include <map>
#include <string>
#include <vector>

namespace segue::testing {
namespace {

using ::testing::HasSubstr;

const std::vector<std::string> kServers = {"amcl",
                                           "behavior_server",
                                           "bt_navigator",
                                           "collision_monitor",
                                           "controller_server",
                                           "global_costmap",
                                           "local_costmap",
                                           "map_server",
                                           "planner_server",
                                           "smoother_server",
                                           "velocity_smoother",
                                           "waypoint_follower"};

/// A robot whose controllers start nodes, each in a process of its own.
class NodesOfARobot : public SystemTest {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    ros = std::make_unique<Ros2Installation>(folder_, segue::paths::kNodeProgram);
    ::setenv("ROS_DOMAIN_ID", std::to_string(dds_domain_of_process()).c_str(), 1);
    ::setenv("ROS_LOCALHOST_ONLY", "1", 1);
    write("rover/robot.yaml",
          "robot: rover\nlibraries: [segue_components_ros2]\ncontrollers: [controllers/*.yaml]\n");
    write("rover/controllers/idle.yaml", "tasks: {}\n");
  }
  void TearDown() override {
    SystemTest::TearDown();
    ros.reset();
  }

  std::unique_ptr<Ros2Installation> ros;
};

/// A set of managed nodes as Nav2 has it.
class NavigationServers : public NodesOfARobot {
 protected:
  void SetUp() override {
    NodesOfARobot::SetUp();
    write("rover/controllers/navigate.yaml", network("meets: " + std::to_string(kServers.size()), ""));
    write("rover/controllers/broken.yaml", network("rate: 1", "dies_in_configure: true"));
    start();
  }

  /// All servers, and one more where `parameters_of_other` are given.
  static std::string network(const std::string& parameters, const std::string& parameters_of_other) {
    std::string tasks;
    std::string names;
    const auto add = [&](const std::string& name, const std::string& with) {
      tasks += "  " + name + ": {component: 'ros2::ManagedNode', properties: {name: /" + name +
               ", timeout: 100s, process: {package: test_nodes, executable: managed}, parameters: {" + with +
               "}}}\n";
      names += (names.empty() ? "" : ", ") + name;
    };
    for (const std::string& server : kServers)
      add(server, parameters);
    if (!parameters_of_other.empty()) add("other", parameters_of_other);
    return "tasks:\n" + tasks + "deployments: {ros2: {tasks: [" + names + "], on_failure: recover}}\n";
  }
  std::map<std::string, pid_t> pids() const {
    std::map<std::string, pid_t> all;
    for (const std::string& server : kServers)
      all[server] = ros->pid_of(server);
    return all;
  }
  static bool are_gone(const std::map<std::string, pid_t>& all) {
    return eventually([&] {
      return std::ranges::all_of(all, [](const auto& each) { return ::kill(each.second, 0) != 0; });
    });
  }
};

TEST_F(NavigationServers, AreConfiguredAllAtOnce) {
  const auto finished = segue({"switch", "navigate", "--timeout", "120s"});
  ASSERT_EQ(finished.status, 0) << finished.output << finished.errors
                                << "each of them waits in configure until all are there";
  const auto before = pids();
  EXPECT_EQ(segue({"switch", "idle"}).status, 0);
  EXPECT_TRUE(are_gone(before));
}

TEST_F(NavigationServers, AreBroughtBackOneByOne) {
  ASSERT_EQ(segue({"switch", "navigate", "--timeout", "120s"}).status, 0);
  auto before = pids();
  ::kill(before["amcl"], SIGKILL);
  EXPECT_TRUE(eventually([&] {
    return ros->pid_of("amcl") != before["amcl"] &&
           segue({"status"}).output.find("exception") == std::string::npos;
  }));
  ASSERT_NO_FATAL_FAILURE(wait_for_controller("navigate"));
  auto after = pids();
  before.erase("amcl");
  after.erase("amcl");
  EXPECT_EQ(after, before) << "the others go on";
}

TEST_F(NavigationServers, AreAllUndoneWhereOneFails) {
  const auto finished = segue({"switch", "broken", "--timeout", "120s"});
  EXPECT_NE(finished.status, 0);
  EXPECT_THAT(finished.output + finished.errors,
              HasSubstr("the process of node /other was killed by signal 9"));
  EXPECT_TRUE(are_gone(pids()));
}

TEST_F(NavigationServers, EndWithTheProcessThatHasStartedThem) {
  ASSERT_EQ(segue({"switch", "navigate", "--timeout", "120s"}).status, 0);
  const auto before = pids();
  for (const auto& [pid, program] : processes_of(folder_ / "runtime"))
    ::kill(pid, SIGKILL);
  EXPECT_TRUE(are_gone(before));
}

/// A node that counts, and one that listens to it by way of a connection.
class ConnectedNodes : public NodesOfARobot {
 protected:
  void SetUp() override {
    NodesOfARobot::SetUp();
    write("rover/controllers/narrow.yaml", network("/words", "5000"));
    write("rover/controllers/wide.yaml", network("/words", "8000",
                                                 "  also: {component: 'ros2::Subscription', properties: "
                                                 "{topic: /also, type: std_msgs/msg/String}}\n",
                                                 "  also: {tasks: [also]}\n"));
    write("rover/controllers/twice.yaml", network("/numbers", "5000"));
    start();
  }

  /// `topic` is that of the listener, `size` that of the connection.
  static std::string network(const std::string& topic, const std::string& size, const std::string& tasks = "",
                             const std::string& deployments = "") {
    const auto node = [](const std::string& name, const std::string& ports) {
      return "  " + name + ":\n    component: ros2::Node\n    properties: {name: /" + name +
             ", timeout: 100s, process: {package: test_nodes, executable: " + name + "}, " + ports + "}\n";
    };
    return "tasks:\n" +
           node("counter",
                "publishes: {numbers: {type: std_msgs/msg/String, depth: 10000}}, ready: [numbers]") +
           node("listener",
                "subscribes: {words: {topic: " + topic + ", type: std_msgs/msg/String, depth: 10000}}") +
           tasks +
           "connections:\n  - {from: counter.numbers, to: listener.words, policy: buffer, size: " + size +
           "}\ndeployments:\n  counter: {tasks: [counter]}\n  listener: {tasks: [listener]}\n" + deployments;
  }
  int heard() const { return std::atoi(ros->noted("listener.heard").c_str()); }
};

TEST_F(ConnectedNodes, LoseNoSampleInSwitchesThatKeepThem) {
  ASSERT_EQ(segue({"switch", "narrow", "--timeout", "120s"}).status, 0);
  const pid_t counter = ros->pid_of("counter");
  for (int i = 0; i < 6; ++i) {
    const int before = heard();
    ASSERT_TRUE(eventually([&] { return heard() > before + 50; })) << ros->noted("listener.heard");
    const auto switched = segue({"switch", i % 2 == 0 ? "wide" : "narrow", "--timeout", "120s"});
    ASSERT_EQ(switched.status, 0) << switched.output << switched.errors;
  }
  const int before = heard();
  ASSERT_TRUE(eventually([&] { return heard() > before + 50; }));
  EXPECT_THAT(ros->noted("listener.heard"), HasSubstr(" heard, 0 gaps"));
  EXPECT_EQ(ros->pid_of("counter"), counter) << "it was kept";
}

TEST_F(ConnectedNodes, OfOneTopicAreNotConnected) {
  const auto checked = segue({"check", "rover/controllers/twice.yaml", "--robot-file", "rover/robot.yaml"});
  EXPECT_EQ(checked.status, 1);
  EXPECT_THAT(checked.output + checked.errors, HasSubstr("both are topic /numbers of ROS 2"));
  const auto switched = segue({"switch", "twice", "--timeout", "120s"});
  EXPECT_NE(switched.status, 0);
  EXPECT_THAT(switched.output + switched.errors,
              HasSubstr("counter.numbers and listener.words are both topic /numbers of ROS 2"));
}

/// Two components of a container that a robot has started.
class RunningContainer : public NodesOfARobot {
 protected:
  void SetUp() override {
    NodesOfARobot::SetUp();
    write("rover/controllers/load.yaml", "tasks:\n" + task("planner") + task("smoother") +
                                             "deployments: {ros2: {tasks: [planner, smoother]}}\n");
    start();
    ASSERT_EQ(segue({"switch", "load", "--timeout", "120s"}).status, 0);
  }
  static std::string task(const std::string& name) {
    return "  " + name + ": {component: 'ros2::ManagedNode', properties: {name: /" + name +
           ", timeout: 100s, process: {package: test_nodes, component: 'test::Managed', container: /nav}, "
           "parameters: {rate: 7}}}\n";
  }
  [[nodiscard]] std::string imported(const std::string& folder) const {
    return read_file(folder_ / folder / "controllers/nodes.yaml").value_or("");
  }
};

TEST_F(RunningContainer, IsDescribedWithItsComponents) {
  const auto container = segue({"ros2", "describe", "/nav", "--wait", "100s", "--timeout", "100s"});
  ASSERT_EQ(container.status, 0) << container.errors;
  EXPECT_THAT(container.output,
              ::testing::ContainsRegex("[12] +/planner +test::Managed of package test_nodes"));
  EXPECT_THAT(container.output,
              ::testing::ContainsRegex("[12] +/smoother +test::Managed of package test_nodes"));
  EXPECT_THAT(
      segue({"ros2", "describe", "/smoother", "--wait", "100s", "--timeout", "100s"}).output,
      ::testing::ContainsRegex("container: /nav, component [12]: test::Managed of package test_nodes\n"));
  std::string nodes;
  EXPECT_TRUE(eventually([&] {
    nodes = segue({"ros2", "nodes", "--wait", "2s"}).output;
    return ::testing::Value(nodes, ::testing::ContainsRegex("/planner +yes .* /nav +rclcpp_components"));
  })) << nodes;
}

TEST_F(RunningContainer, BecomesPartOfAnImportedRobot) {
  int tries = 0;
  std::string folder;
  ASSERT_TRUE(eventually([&] {
    folder = "robot" + std::to_string(++tries);
    segue({"import", "ros2", folder, "--name", "rover", "--timeout", "100s"});
    const std::string network = imported(folder);
    return network.find("name: /planner\n") != std::string::npos &&
           network.find("/smoother\n      parameters: {rate: 7}\n      process:") != std::string::npos;
  })) << imported(folder);
  std::string network = imported(folder);
  EXPECT_THAT(network, HasSubstr("component: 'test::Managed'"));
  EXPECT_THAT(network, ::testing::Not(HasSubstr("name: /nav\n")));
  const pid_t before = ros->pid_of("nav");
  ASSERT_EQ(stop().status, 0);
  ASSERT_TRUE(eventually([&] { return ::kill(before, 0) != 0; }));
  for (const char* name : {"/planner", "/smoother"}) {
    const std::string line = "      name: " + std::string(name) + "\n";
    network.insert(network.find(line), "      timeout: 100s\n");
  }
  write(folder + "/controllers/nodes.yaml", network);
  robot_ =
      std::make_unique<Process>(command({"run", folder + "/robot.yaml", "--controller", "nodes"}), folder_);
  ASSERT_TRUE(robot_->wait_for("robot rover runs")) << robot_->wait().errors;
  ASSERT_TRUE(eventually([&] { return controller() == "nodes"; })) << network;
  EXPECT_NE(ros->pid_of("nav"), before);
  EXPECT_EQ(ros->pid_of("smoother"), ros->pid_of("nav"));
  EXPECT_THAT(ros->noted("smoother"), HasSubstr("rate: 7"));
  EXPECT_EQ(stop().status, 0);
}

}  // namespace
}  // namespace segue::testing
