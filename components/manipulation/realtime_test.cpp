// SPDX-License-Identifier: Apache-2.0
//
// The updates of the components allocate nothing.
#include "pose_servo.hpp"
#include "simulated_arm.hpp"

#include "../messages/motion.hpp"

#include <support/allocation_trap.hpp>

#include <gtest/gtest.h>

namespace manipulation {
namespace {

using segue::type::Value;
using test::value_of;

TEST(ManipulationRealtime, UpdatesDoNotAllocate) {
  test::SimulatedArm arm;
  arm.add("servo", "manipulation::CartesianController");
  arm.add_whole_body("body");
  const std::vector<Waypoint> waypoints = {{"bent", test::bent()}};
  arm.add("waypoints", "manipulation::JointWaypoints",
          Value::map({{"waypoints", value_of(waypoints)}, {"sequence", Value::list({"bent"})}}));
  arm.add("tracker", "manipulation::MarkerTracker", Value::map({{"marker_id", 7}}));
  const std::vector<TimedTwist> script = {{{{0, 0, -0.1}, {0, 0, 0}}, 1.0}};
  arm.add("mouse", "manipulation::ScriptedTwist", Value::map({{"script", value_of(script)}}));
  arm.connect(arm.output("kinematics", "pose"), arm.input("servo", "pose"));
  arm.connect(arm.output("kinematics", "timed_pose"), arm.input("tracker", "tip"));
  arm.connect(arm.driver.markers, arm.input("tracker", "markers"));
  arm.connect(arm.driver.target, arm.input("servo", "target"));
  arm.connect(arm.output("servo", "twist"), arm.input("body", "twist"));
  arm.add("splitter", "manipulation::CommandSplitter");
  arm.connect(arm.output("mouse", "twist"), arm.input("splitter", "twist"));
  arm.connect(arm.output("splitter", "arm"), arm.input("body", "twist"));
  arm.connect(arm.output("body", "command"), arm.input("generator", "command"));
  arm.connect(arm.output("waypoints", "command"), arm.input("generator", "command"));
  arm.connect(arm.driver.joints, arm.input("waypoints", "joints"));
  for (const char* task : {"generator", "servo", "body", "tracker"})
    arm.start(task);
  arm.run(0.1);
  Pose target;
  arm.driver.pose.read(target);
  const auto start = arm.state.positions;
  target.position.x() -= 0.2;

  const auto run_trapped = [&] {
    for (int i = 0; i < 100; ++i) {
      arm.state.time = arm.seconds();
      arm.driver.joints.write(arm.state);
      arm.driver.markers.write({arm.seconds(), {{7, {}}}});
      arm.driver.target.write(target);
      segue::testing::trapped = true;
      arm.advance(std::chrono::milliseconds(10));
      segue::testing::trapped = false;
      arm.driver.set_points.read(arm.command);
      arm.state.positions = arm.command.positions;
    }
  };
  run_trapped();
  EXPECT_NE(arm.state.positions, start) << "it moves";
  arm.start("waypoints");
  arm.start("mouse");
  arm.start("splitter");
  run_trapped();
  EXPECT_EQ(segue::testing::caught, 0);
}

TEST(ManipulationRealtime, FollowingAPathDoesNotAllocate) {
  test::SimulatedArm arm;
  arm.add("follower", "manipulation::JointPathFollower",
          Value::map({{"limits", value_of(test::seven_limits())}}));
  arm.connect(arm.driver.joints, arm.input("follower", "joints"));
  arm.connect(arm.output("follower", "command"), arm.driver.set_points);
  arm.start("follower");
  arm.run(0.1);
  const auto start = arm.state.positions;
  const messages::JointPath path{{start, std::vector<double>(7, 0.1)}};
  ASSERT_TRUE(arm.call("follower", "follow", Value::map({{"path", value_of(path)}})));
  for (int i = 0; i < 100; ++i) {
    arm.state.time = arm.seconds();
    arm.driver.joints.write(arm.state);
    segue::testing::trapped = true;
    arm.advance(std::chrono::milliseconds(10));
    segue::testing::trapped = false;
    arm.driver.set_points.read(arm.command);
    arm.state.positions = arm.command.positions;
  }
  EXPECT_NE(arm.state.positions, start) << "it moves";
  EXPECT_EQ(segue::testing::caught, 0);
}

}  // namespace
}  // namespace manipulation
