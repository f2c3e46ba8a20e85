// SPDX-License-Identifier: Apache-2.0
//
// The components together, with a simulated arm.
#include "arm_kinematics.hpp"
#include "pose_servo.hpp"
#include "simulated_arm.hpp"

#include "../messages/motion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace manipulation {
namespace {

using segue::type::Value;
using test::SimulatedArm;
using test::value_of;

class Arm : public ::testing::Test {
 protected:
  [[nodiscard]] std::string state(const std::string& task) { return arm.task(task).state_name(); }
  /// Controllers of the tip, from a target to commands for the generator.
  void add_cartesian() {
    arm.add("servo", "manipulation::CartesianController");
    arm.add_whole_body("body");
    arm.connect(arm.output("kinematics", "pose"), arm.input("servo", "pose"));
    arm.connect(arm.output("servo", "twist"), arm.input("body", "twist"));
    arm.connect(arm.output("body", "command"), arm.input("generator", "command"));
  }
  void add_waypoints(const std::string& generator) {
    const std::vector<Waypoint> waypoints = {{"bent", test::bent()}, {"home", {0, 0.3, 0, 0.9, 0, 0.6, 0}}};
    arm.add("waypoints", "manipulation::JointWaypoints", Value::map({{"waypoints", value_of(waypoints)}}));
    arm.connect(arm.driver.joints, arm.input("waypoints", "joints"));
    arm.connect(arm.output("waypoints", "command"), arm.input(generator, "command"));
  }
  [[nodiscard]] Pose tip() {
    Pose pose;
    arm.driver.pose.read(pose);
    return pose;
  }
  [[nodiscard]] double distance_from(const std::vector<double>& positions) const {
    double farthest = 0;
    for (std::size_t i = 0; i < positions.size(); ++i)
      farthest = std::max(farthest, std::abs(positions[i] - arm.state.positions[i]));
    return farthest;
  }

  SimulatedArm arm;
};

TEST_F(Arm, TheTipReachesAPoseAndStaysThere) {
  add_cartesian();
  for (const char* task : {"generator", "servo", "body"})
    arm.start(task);
  arm.advance(std::chrono::milliseconds(10));
  EXPECT_EQ(state("servo"), "waiting");
  arm.run(0.5);
  EXPECT_EQ(state("servo"), "idle");
  EXPECT_EQ(distance_from(test::bent()), 0) << "it rests without a target";

  Pose target = tip();
  target.position += Eigen::Vector3d(0.1, -0.15, -0.1);
  target.orientation = Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX()) * target.orientation;
  ASSERT_TRUE(arm.call("servo", "set_target", Value::map({{"target", value_of(target)}})));
  arm.run(0.5);
  EXPECT_EQ(state("servo"), "reaching");
  EXPECT_EQ(state("generator"), "moving");
  arm.run(10);
  EXPECT_EQ(state("servo"), "reached");
  const PoseError left = error_between(tip(), target);
  EXPECT_LT(left.translation.norm(), 0.005);
  EXPECT_LT(left.rotation.norm(), 0.02);

  arm.stop("servo");
  arm.run(2);
  EXPECT_EQ(state("body"), "holding");
  EXPECT_EQ(state("generator"), "holding");
}

TEST_F(Arm, GoesToNamedConfigurations) {
  add_waypoints("generator");
  arm.start("generator");
  arm.start("waypoints");
  arm.run(0.2);
  EXPECT_EQ(state("waypoints"), "idle");
  EXPECT_EQ(state("generator"), "holding");
  ASSERT_TRUE(arm.call("waypoints", "go_to", Value::map({{"name", "home"}})));
  arm.run(0.2);
  EXPECT_EQ(state("waypoints"), "moving");
  arm.run(5);
  EXPECT_EQ(state("waypoints"), "reached");
  EXPECT_LT(distance_from({0, 0.3, 0, 0.9, 0, 0.6, 0}), 0.01);
  const auto nowhere = arm.call("waypoints", "go_to", Value::map({{"name", "hmoe"}}));
  ASSERT_FALSE(nowhere);
  EXPECT_THAT(nowhere.error().message, ::testing::HasSubstr("hmoe"));
}

TEST_F(Arm, ComesToRestOnItsWayWhereNobodyCanCommandItAnyMore) {
  add_waypoints("generator");
  arm.start("generator");
  arm.start("waypoints");
  arm.run(0.2);
  ASSERT_TRUE(arm.call("waypoints", "go_to", Value::map({{"name", "home"}})));
  arm.run(0.3);
  EXPECT_EQ(state("generator"), "moving");
  arm.input("generator", "command").disconnect_all();
  arm.run(2);
  EXPECT_EQ(state("generator"), "holding");
  EXPECT_GT(distance_from({0, 0.3, 0, 0.9, 0, 0.6, 0}), 0.1) << "it has not gone on";
}

/// The follower in place of the generator.
class FollowingArm : public Arm {
 protected:
  FollowingArm() {
    arm.add("follower", "manipulation::JointPathFollower",
            Value::map({{"limits", value_of(test::seven_limits())}}));
    arm.connect(arm.driver.joints, arm.input("follower", "joints"));
    arm.connect(arm.output("follower", "command"), arm.driver.set_points);
  }
  auto follow(const std::vector<std::vector<double>>& points) {
    return arm.call("follower", "follow", Value::map({{"path", value_of(messages::JointPath{points})}}));
  }
  const std::vector<double> home{0, 0.3, 0, 0.9, 0, 0.6, 0};
};

TEST_F(FollowingArm, PassesAllPointsOfAPathAndStopsAtItsEnd) {
  arm.start("follower");
  arm.run(0.1);
  EXPECT_EQ(state("follower"), "idle");
  std::vector<double> aside = test::bent();
  aside[0] += 0.8;
  ASSERT_TRUE(follow({test::bent(), aside, home}));
  double closest = 1;
  for (int i = 0; i < 500 && state("follower") != "reached"; ++i) {
    arm.step();
    closest = std::min(closest, distance_from(aside));
  }
  EXPECT_LT(closest, 0.02) << "by the corner";
  EXPECT_EQ(state("follower"), "reached");
  EXPECT_LT(distance_from(home), 1e-9);
  ASSERT_TRUE(follow({home, test::bent()}));
  arm.step();
  EXPECT_EQ(state("follower"), "moving");
  const auto another = follow({home, test::bent()});
  ASSERT_FALSE(another);
  EXPECT_THAT(another.error().message, ::testing::HasSubstr("still follows another path"));
}

TEST_F(FollowingArm, RefusesPathsThatBeginElsewhereOrAreNone) {
  arm.start("follower");
  ASSERT_TRUE(follow({home, test::bent()})) << "nothing is known of the arm yet";
  arm.run(0.1);
  EXPECT_EQ(state("follower"), "refused");
  EXPECT_LT(distance_from(test::bent()), 1e-9) << "it has not moved";
  const auto elsewhere = follow({home, test::bent()});
  ASSERT_FALSE(elsewhere);
  EXPECT_THAT(elsewhere.error().message, ::testing::HasSubstr("away from where the arm is"));
  EXPECT_FALSE(follow({}));
  EXPECT_FALSE(follow({{1, 2}}));
  std::vector<double> wrong = test::bent();
  wrong[3] = std::nan("");
  EXPECT_FALSE(follow({test::bent(), wrong}));
  ASSERT_TRUE(follow({test::bent(), home}));
  arm.run(3);
  EXPECT_EQ(state("follower"), "reached");
}

TEST_F(Arm, AnotherGeneratorGoesOnWithTheMotionWithoutAJump) {
  const double dt = 0.01;
  add_cartesian();
  for (const char* task : {"generator", "servo", "body"})
    arm.start(task);
  arm.run(0.1);
  Pose target = tip();
  target.position += Eigen::Vector3d(0.2, 0.2, -0.2);
  ASSERT_TRUE(arm.call("servo", "set_target", Value::map({{"target", value_of(target)}})));
  arm.run(0.6);
  EXPECT_EQ(state("generator"), "moving");

  arm.add_generator("other");
  add_waypoints("other");
  const auto before = arm.command;
  arm.stop("generator");
  const auto saved = arm.task("generator").save_state(SimulatedArm::soon());
  ASSERT_TRUE(saved && *saved);
  ASSERT_TRUE(arm.task("other").configure(SimulatedArm::soon()));
  ASSERT_TRUE(arm.task("other").restore_state(**saved, SimulatedArm::soon()));
  ASSERT_TRUE(arm.task("other").start(SimulatedArm::soon()));
  arm.start("waypoints");
  ASSERT_TRUE(arm.call("waypoints", "go_to", Value::map({{"name", "home"}})));
  auto last = before;
  for (int i = 0; i < 500; ++i) {
    arm.step();
    for (std::size_t j = 0; j < 7; ++j) {
      const double velocity = arm.command.velocities[j];
      ASSERT_LE(std::abs(velocity - last.velocities[j]), 4 * dt + 1e-6) << "acceleration of joint " << j;
      ASSERT_LE(std::abs(arm.command.positions[j] - last.positions[j]), 1.5 * dt + 1e-6);
    }
    last = arm.command;
  }
  EXPECT_EQ(state("waypoints"), "reached");
}

TEST_F(Arm, AGeneratorRefusesAMotionThatIsNotItsOwn) {
  arm.start("generator");
  arm.stop("generator");
  auto& generator = arm.task("generator");
  const TrajectoryState three{{1, 2, 3}, {0, 0, 0}, {0, 0, 0}};
  EXPECT_FALSE(generator.restore_state(segue::task::make_state(three, 1), SimulatedArm::soon()));
  EXPECT_FALSE(generator.restore_state(segue::task::make_state(three, 2), SimulatedArm::soon()));
  const auto saved = generator.save_state(SimulatedArm::soon());
  ASSERT_TRUE(saved);
  EXPECT_FALSE(*saved) << "it has never moved the arm";
}

TEST_F(Arm, ComesToRestWhenCommandsStop) {
  segue::task::OutputPort<messages::JointCommand> hand(arm.driver, "hand");
  arm.connect(hand, arm.input("generator", "command"));
  arm.start("generator");
  arm.advance(std::chrono::milliseconds(10));
  EXPECT_EQ(state("generator"), "waiting");
  arm.run(0.05);
  hand.write({.time = 0, .positions = {}, .velocities = std::vector<double>(7, 0.2)});
  arm.run(0.15);
  EXPECT_EQ(state("generator"), "moving");
  arm.run(1);
  EXPECT_EQ(state("generator"), "holding");
  const auto rest = arm.state.positions;
  EXPECT_GT(distance_from(test::bent()), 0.01);
  hand.write({.time = 0, .positions = {1, 2}, .velocities = {}});
  arm.run(1);
  EXPECT_EQ(arm.state.positions, rest) << "what makes no sense is ignored";
}

TEST_F(Arm, IgnoresPosesAndVelocitiesThatAreNoNumbers) {
  segue::task::OutputPort<messages::Twist> hand(arm.driver, "hand");
  segue::task::OutputPort<messages::Pose> pose(arm.driver, "wrong_pose");
  add_cartesian();
  arm.connect(hand, arm.input("body", "twist"));
  arm.connect(pose, arm.input("servo", "pose"));
  for (const char* task : {"generator", "servo", "body"})
    arm.start(task);
  arm.run(0.1);
  Pose target = tip();
  target.position.x() -= 0.1;
  ASSERT_TRUE(arm.call("servo", "set_target", Value::map({{"target", value_of(target)}})));
  const double no_number = std::nan("");
  for (int i = 0; i < 300; ++i) {
    hand.write({{no_number, 0, 0}, {0, 0, 0}});
    pose.write({{0, no_number, 0}, Eigen::Quaterniond::Identity()});
    arm.step();
    for (const double position : arm.command.positions)
      ASSERT_TRUE(std::isfinite(position));
  }
  EXPECT_LT((tip().position - target.position).norm(), 0.03);
}

TEST_F(Arm, PlaysAScriptLikeA3DMouse) {
  arm.add_whole_body("body");
  const std::vector<TimedTwist> script = {{{{0, 0, -0.1}, {0, 0, 0}}, 1.0}, {{{0.1, 0, 0}, {0, 0, 0}}, 0.5}};
  arm.add("mouse", "manipulation::ScriptedTwist", Value::map({{"script", value_of(script)}}));
  arm.connect(arm.output("mouse", "twist"), arm.input("body", "twist"));
  arm.connect(arm.output("body", "command"), arm.input("generator", "command"));
  for (const char* task : {"generator", "body"})
    arm.start(task);
  arm.run(0.1);
  const Pose before = tip();
  arm.start("mouse");
  arm.run(0.9);
  EXPECT_EQ(state("mouse"), "playing");
  arm.run(2);
  EXPECT_EQ(state("mouse"), "done");
  EXPECT_EQ(state("generator"), "holding");
  const Eigen::Vector3d moved = tip().position - before.position;
  EXPECT_LT((moved - Eigen::Vector3d(0.05, 0, -0.1)).norm(), 0.015) << moved.transpose();
}

TEST_F(Arm, AGeneratorMayGoByTheTimeOfASimulatedArm) {
  struct : segue::task::Component {
    segue::task::OutputPort<messages::JointCommand> command{*this, "command"};
  } hand;
  arm.add("slow", "manipulation::TrajectoryGenerator",
          Value::map({{"limits", value_of(test::seven_limits())}, {"robot_time", true}}));
  arm.connect(arm.driver.joints, arm.input("slow", "joints"));
  arm.connect(arm.output("slow", "set_points"), arm.driver.set_points);
  arm.connect(hand.command, arm.input("slow", "command"));
  arm.start("slow");
  std::vector<double> target = test::bent();
  target[0] += 1;
  hand.command.write({0, target, {}});
  // The arm's time is a quarter of the computer's.
  double before = arm.state.positions[0];
  for (int i = 0; i < 400; ++i) {
    arm.state.time += 0.0025;
    arm.driver.joints.write(arm.state);
    arm.advance(std::chrono::milliseconds(10));
    arm.driver.set_points.read(arm.command);
    EXPECT_NEAR(arm.command.time, arm.state.time, 1e-9);
    const double step = arm.command.positions[0] - std::exchange(before, arm.command.positions[0]);
    ASSERT_LE(std::abs(step), 0.0025 * test::seven_joints()[0].velocity + 1e-9);
  }
  EXPECT_GT(before - arm.state.positions[0], 0.3) << "it has moved for a second";
  EXPECT_LT(before, target[0]);
}

/// A 3D mouse whose velocities are dealt out; what the vehicle gets can be read.
class TeleOperation : public Arm {
 protected:
  struct Vehicle : segue::task::Component {
    segue::task::OutputPort<messages::Twist> mouse{*this, "mouse"};
    segue::task::InputPort<messages::Twist2D> drive{*this, "drive"};
    segue::task::InputPort<messages::Twist> tip{*this, "tip"};
  };

  void add_splitter(const std::string& mode) {
    arm.add("splitter", "manipulation::CommandSplitter", Value::map({{"mode", mode}}));
    arm.connect(vehicle.mouse, arm.input("splitter", "twist"));
    arm.connect(arm.output("splitter", "drive"), vehicle.drive);
    arm.connect(arm.output("splitter", "arm"), vehicle.tip);
    arm.start("splitter");
  }
  /// Moves the mouse and reads the outputs 20 ms later.
  void move(const messages::Twist& twist) {
    vehicle.mouse.write(twist);
    arm.advance(std::chrono::milliseconds(20));
    vehicle.drive.read(drive);
    vehicle.tip.read(tip_twist);
  }

  const messages::Twist all{{0.1, 0.2, 0.3}, {0.4, 0.5, 0.6}};
  Vehicle vehicle;
  messages::Twist2D drive;
  messages::Twist tip_twist;
};

TEST_F(TeleOperation, DealsOutTheAxesOfTheMouse) {
  add_splitter("both");
  move(all);
  EXPECT_EQ(state("splitter"), "both");
  EXPECT_EQ(drive.linear, 0.1);
  EXPECT_EQ(drive.angular, 0.6);
  EXPECT_EQ(tip_twist.linear, Eigen::Vector3d(0, 0.2, 0.3));
  EXPECT_EQ(tip_twist.angular, Eigen::Vector3d(0.4, 0.5, 0));
}

TEST_F(TeleOperation, ControlsOneOfBothWhereThatIsWanted) {
  add_splitter("drive");
  move(all);
  EXPECT_EQ(state("splitter"), "drive");
  EXPECT_EQ(drive.linear, 0.1);
  EXPECT_TRUE(tip_twist.linear.isZero(0) && tip_twist.angular.isZero(0));
  ASSERT_TRUE(arm.call("splitter", "control", Value::map({{"what", "arm"}})));
  move(all);
  EXPECT_EQ(state("splitter"), "arm");
  EXPECT_EQ(drive.linear, 0);
  EXPECT_EQ(drive.angular, 0);
  EXPECT_EQ(tip_twist.linear, all.linear);
  const auto refused = arm.call("splitter", "control", Value::map({{"what", "legs"}}));
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, ::testing::HasSubstr("drive, arm or both, not 'legs'"));
}

TEST_F(TeleOperation, StandsStillWhereTheMouseIsSilentOrSaysNonsense) {
  add_splitter("both");
  move(all);
  move({{NAN, 0, 0}, {0, 0, 0}});
  EXPECT_EQ(drive.linear, 0.1) << "which is ignored";
  arm.run(0.3);
  vehicle.drive.read(drive);
  vehicle.tip.read(tip_twist);
  EXPECT_EQ(state("splitter"), "waiting");
  EXPECT_EQ(drive.linear, 0);
  EXPECT_TRUE(tip_twist.linear.isZero(0));
}

/// An object, the camera on the hand that looks for it, and what the tracker finds.
class Camera : public Arm {
 protected:
  explicit Camera(bool on_arm = true) {
    camera.position = {0.05, 0, 0.02};
    camera.orientation = Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY());
    object.position = {0, 0, 0.1};
    truth.position = {0.6, 0.1, 0.1};
    truth.orientation = Eigen::AngleAxisd(1, Eigen::Vector3d::UnitX());
    arm.add("tracker", "manipulation::MarkerTracker",
            Value::map({{"marker_id", 7}, {"camera", value_of(camera)}, {"object_pose", value_of(object)}}));
    if (on_arm) arm.connect(arm.output("kinematics", "timed_pose"), arm.input("tracker", "tip"));
    arm.connect(arm.driver.markers, arm.input("tracker", "markers"));
    arm.connect(arm.output("tracker", "object"), arm.driver.object);
    arm.start("tracker");
    arm.run(0.1);
  }
  /// The marker as the camera sees it from where the tip is.
  [[nodiscard]] Pose seen_from(const Pose& at) const {
    return compose(inverse(compose(at, camera)), compose(truth, inverse(object)));
  }
  void show(double time, std::int32_t id, const Pose& pose) {
    arm.driver.markers.write({time, {{3, {}}, {id, pose}}});
  }
  void expect_found() {
    Pose found;
    ASSERT_EQ(arm.driver.object.read(found), segue::task::ReadStatus::NewData);
    EXPECT_LT((found.position - truth.position).norm(), 1e-3);
    EXPECT_LT(found.orientation.angularDistance(truth.orientation), 1e-3);
  }

  Pose camera;  ///< on the tip
  Pose object;  ///< in the frame of the marker
  Pose truth;   ///< of the object
};

TEST_F(Camera, FindsAMarkedObjectAndLosesIt) {
  EXPECT_EQ(state("tracker"), "lost");
  for (int i = 0; i < 20; ++i, arm.run(0.05))
    show(arm.seconds(), 7, seen_from(tip()));
  EXPECT_EQ(state("tracker"), "tracking");
  expect_found();
  for (int i = 0; i < 20; ++i, arm.run(0.05))
    show(arm.seconds(), 8, seen_from(tip()));
  EXPECT_EQ(state("tracker"), "lost") << "that is another marker";
}

TEST_F(Camera, UsesThePoseFromWhichTheImageWasTaken) {
  arm.start("generator");
  segue::task::OutputPort<messages::JointCommand> hand(arm.driver, "hand");
  arm.connect(hand, arm.input("generator", "command"));
  arm.run(0.05);
  struct Taken {
    double time;
    Pose marker;
  };
  std::vector<Taken> images;
  const Pose first = tip();
  for (int i = 0; i < 100; ++i) {
    hand.write({.time = 0, .positions = {}, .velocities = std::vector<double>(7, 0.3)});
    // The camera sees the joints as they were at the beginning of this step.
    const double time = arm.seconds();
    arm.step();
    images.push_back({time, seen_from(tip())});
    if (images.size() > 10) show(images[images.size() - 10].time, 7, images[images.size() - 10].marker);
  }
  EXPECT_GT((tip().position - first.position).norm(), 0.1) << "the arm moves";
  expect_found();
}

class FixedCamera : public Camera {
 protected:
  FixedCamera() : Camera(false) {}
};

TEST_F(FixedCamera, NeedsNoArm) {
  for (int i = 0; i < 5; ++i, arm.run(0.05))
    show(arm.seconds(), 7, seen_from({}));
  EXPECT_EQ(state("tracker"), "tracking");
  expect_found();
}

}  // namespace
}  // namespace manipulation
