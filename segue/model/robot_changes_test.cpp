// SPDX-License-Identifier: Apache-2.0
#include <segue/model/robot_changes.hpp>

#include <gtest/gtest.h>

namespace segue::model {
namespace {

struct ChangedRobot : ::testing::Test {
  ChangedRobot() {
    robot.name = "rover";
    robot.pools.emplace_back().name = "planner";
    Task task;
    task.id = TaskId("arm");
    task.properties.as_map().set("speed", 1);
    task.properties.as_map().set("limit", 2);
    controllers.resize(3);
    controllers[0].tasks.push_back(task);
    controllers[2].tasks.push_back(task);
  }
  ErrorCode refused(const RobotChanges& changes) {
    const auto applied = apply(changes, robot, controllers);
    return applied ? ErrorCode::Internal : applied.error().code;
  }
  Robot robot;
  std::vector<Network> controllers;
};

TEST_F(ChangedRobot, HasOtherPropertiesInAllControllersAndPools) {
  ASSERT_TRUE(
      apply({{{"planner", 3}}, {{"arm.speed", 5}, {"planner.effort", 0.5}}}, robot, controllers).has_value());
  EXPECT_EQ(robot.pools[0].most, 3);
  EXPECT_EQ(*robot.pools[0].task.properties.find("effort"), type::Value(0.5));
  for (const std::size_t i : {0U, 2U}) {
    const Task& arm = controllers[i].tasks[0];
    EXPECT_EQ(*arm.properties.find("speed"), type::Value(5));
    EXPECT_EQ(*arm.properties.find("limit"), type::Value(2));
  }
  EXPECT_TRUE(controllers[1].empty());
}

TEST_F(ChangedRobot, MustHaveWhatIsChanged) {
  EXPECT_EQ(refused({{{"planer", 1}}, {}}), ErrorCode::NotFound);
  EXPECT_EQ(refused({{{"planner", 0}}, {}}), ErrorCode::InvalidArgument);
  EXPECT_EQ(refused({{{"planner", kLargestPool + 1}}, {}}), ErrorCode::InvalidArgument);
  EXPECT_EQ(refused({{}, {{"leg.speed", 1}}}), ErrorCode::NotFound);
  EXPECT_EQ(refused({{}, {{"arm", 1}}}), ErrorCode::InvalidArgument);
}

}  // namespace
}  // namespace segue::model
