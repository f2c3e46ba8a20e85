// SPDX-License-Identifier: Apache-2.0
//
// The updates of the components allocate nothing.
#include "../test_network.hpp"
#include "simulated_room.hpp"

#include <segue/task/component.hpp>
#include <support/allocation_trap.hpp>

#include <gtest/gtest.h>

#include <chrono>

namespace navigation {
namespace {

using namespace std::chrono_literals;
using components_test::TestNetwork;
using segue::type::Value;

struct Sensors : segue::task::Component {
  segue::task::OutputPort<messages::Odometry> odometry{*this, "odometry"};
  segue::task::OutputPort<messages::LaserScan> scan{*this, "scan"};
  segue::task::InputPort<messages::Twist2D> command{*this, "command"};
};

TEST(NavigationRealtime, UpdatesDoNotAllocate) {
  const test::Room room = test::two_rooms();
  Sensors sensors;
  TestNetwork network;
  network.add("mapper", "navigation::GridMapper",
              Value::map({{"x", -0.5}, {"y", -0.5}, {"width", 9.0}, {"height", 7.0}}));
  network.add("localization", "navigation::Localization");
  network.add("planner", "navigation::PathPlanner");
  network.add("follower", "navigation::PathFollower");
  network.add("explorer", "navigation::FrontierExplorer");
  for (const char* task : {"mapper", "planner", "follower", "explorer"})
    network.connect(network.output("localization", "pose"), network.input(task, "pose"));
  network.connect(sensors.odometry, network.input("localization", "odometry"));
  for (const char* task : {"mapper", "follower", "localization"})
    network.connect(sensors.scan, network.input(task, "scan"));
  for (const char* task : {"planner", "explorer", "localization"})
    network.connect(network.output("mapper", "map"), network.input(task, "map"));
  network.connect(network.output("explorer", "goal"), network.input("planner", "goal"));
  network.connect(network.output("planner", "path"), network.input("follower", "path"));
  network.connect(network.output("follower", "command"), sensors.command);
  for (const char* task : {"localization", "mapper", "planner", "follower", "explorer"})
    network.start(task);

  Pose2D pose{1, 1, 0.3};
  messages::Twist2D command;
  for (int i = 0; i < 600; ++i) {
    sensors.command.read(command);
    pose = moved(pose, command, 0.05);
    messages::LaserScan scan = room.scan(pose, 180, 5);
    scan.time = network.seconds();
    sensors.odometry.write({scan.time, pose, command});
    sensors.scan.write(scan);
    segue::testing::trapped = true;
    network.advance(50ms);
    segue::testing::trapped = false;
  }
  EXPECT_EQ(segue::testing::caught, 0);
  EXPECT_GT(std::hypot(pose.x - 1, pose.y - 1), 1) << "it has planned and driven";
}

}  // namespace
}  // namespace navigation
