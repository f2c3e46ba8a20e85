// SPDX-License-Identifier: Apache-2.0
#include <segue/model/files.hpp>
#include <segue/model/robot.hpp>
#include <segue/model/validate.hpp>

#include <gtest/gtest.h>

#include <chrono>
#include <set>
#include <string>
#include <utility>

namespace segue::model {
namespace {

std::string problem_of(const std::string& pool) {
  Diagnostics diagnostics;
  read_robot("robot: r\npools: {planner: " + pool + "}\n", "robot.yaml", diagnostics);
  return diagnostics.items().empty() ? "" : diagnostics.items().front().message;
}

Robot robot_with(const std::string& pools) {
  Diagnostics diagnostics;
  const auto robot = read_robot("robot: r\npools: " + pools + "\n", "robot.yaml", diagnostics);
  EXPECT_FALSE(diagnostics.has_errors()) << diagnostics.to_error().message;
  return robot.value_or(Robot{});
}

TEST(Pools, AreEqualTasksInProcessesOfTheirOwn) {
  const auto robot = robot_with(
      "{planner: {component: demo::RoutePlanner, size: 2, properties: {seed: 7}, process: {cpu: [1]}}}");
  const Network network = pool_network(robot.pools);
  ASSERT_EQ(network.tasks.size(), 2U);
  ASSERT_EQ(network.deployments.size(), 2U);
  EXPECT_EQ(network.tasks[0].id, TaskId("planner_1"));
  EXPECT_EQ(network.tasks[1].id, TaskId("planner_2"));
  EXPECT_EQ(network.tasks[1].properties, robot.pools[0].task.properties);
  EXPECT_EQ(network.tasks[1].on_failure, FailurePolicy::Restart);
  EXPECT_EQ(network.deployments[1].process, ProcessName("planner_2"));
  EXPECT_EQ(network.deployments[1].cpus, std::vector<int>{1});
  ASSERT_EQ(network.deployments[1].tasks.size(), 1U);
  EXPECT_EQ(network.deployments[1].tasks[0].task, TaskId("planner_2"));
  EXPECT_FALSE(validate(network, {}, Depth::Structure).has_errors());
}

TEST(Pools, HaveOneInstanceUnlessTheySayMore) {
  const Pool pool = robot_with("{planner: {component: demo::RoutePlanner}}").pools[0];
  EXPECT_EQ(pool.least, 1);
  EXPECT_EQ(pool.most, 1);
}

TEST(Pools, HaveSizesThatAreRanges) {
  const auto robot = robot_with(
      "{a: {component: x::A, size: 1..3}, b: {component: x::A, size: 0..256, idle_after: 2min},\n"
      "c: {component: x::A, size: 4}}");
  const auto range = [&](std::size_t i) { return std::pair(robot.pools[i].least, robot.pools[i].most); };
  EXPECT_EQ(range(0), std::pair(1, 3));
  EXPECT_EQ(range(1), std::pair(0, 256));
  EXPECT_EQ(range(2), std::pair(4, 4));
  EXPECT_EQ(robot.pools[1].idle_after, std::chrono::minutes(2));
  EXPECT_EQ(pool_network({robot.pools[0]}).tasks.size(), 3U) << "as many as there may be";
}

TEST(Pools, SizesThatAreNoneAreFound) {
  for (const char* size :
       {"3..1", "0..0", "0", "1..257", "-1..2", "1..", "..3", "1..2..3", "1.5", "many", "[1, 2]", "1 .. 3"}) {
    EXPECT_NE(problem_of("{component: a::B, size: " + std::string(size) + "}").find("'size' must be"),
              std::string::npos)
        << size;
  }
  EXPECT_NE(problem_of("{component: a::B, size: 0..2, idle_after: 0s}").find("longer"), std::string::npos);
  EXPECT_NE(problem_of("{component: a::B, size: 1..2, exclusive: [camera]}").find("camera"),
            std::string::npos);
}

TEST(Pools, HaveABudget) {
  Diagnostics diagnostics;
  auto robot = read_robot("robot: r\npool_budget: {processes: 3, memory: 1GB}\n", "r.yaml", diagnostics);
  ASSERT_TRUE(robot);
  EXPECT_EQ(robot->pool_budget, (PoolBudget{3, 1'000'000'000}));
  robot = read_robot("robot: r\npool_budget: {processes: -1}\n", "r.yaml", diagnostics);
  EXPECT_FALSE(robot);
}

TEST(Pools, MistakesInThemAreFound) {
  EXPECT_NE(problem_of("{size: 2}").find("component"), std::string::npos);
  EXPECT_NE(problem_of("{component: a::B, size: 0}").find("size"), std::string::npos);
  EXPECT_NE(problem_of("{component: a::B, sise: 2}").find("sise"), std::string::npos);
  EXPECT_NE(problem_of("{component: a::B, state: stopped}").find("state"), std::string::npos);
  EXPECT_NE(problem_of("{component: a::B, process: {tasks: [x]}}").find("tasks"), std::string::npos);
  EXPECT_NE(problem_of("{component: a::B, on_failure: fallback}").find("fallback"), std::string::npos);
  EXPECT_NE(problem_of("{component: a::B, size: 2, exclusive: [camera]}").find("camera"), std::string::npos);
  EXPECT_EQ(problem_of("{component: a::B, on_failure: report}"), "");
}

TEST(Pools, TheirNamesAndHostsAreChecked) {
  const auto robot = robot_with("{planner: {component: a::B, size: 2, process: {host: nowhere}}}");
  Network controller;
  controller.name = NetworkName("drive");
  controller.tasks.push_back({});
  controller.tasks.back().id = TaskId("planner_2");
  const auto found = validate(robot, {controller});
  std::set<std::string> codes;
  for (const Diagnostic& item : found.items())
    codes.insert(item.code);
  EXPECT_EQ(codes, (std::set<std::string>{"name-of-pool", "unknown-host"}));
}

}  // namespace
}  // namespace segue::model
