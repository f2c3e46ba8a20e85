// SPDX-License-Identifier: Apache-2.0
//
// The components together, in a simulated room.
#include "../test_network.hpp"
#include "grid.hpp"
#include "simulated_room.hpp"
#include "types.hpp"

#include <segue/task/component.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <limits>

namespace navigation {
namespace {

using namespace std::chrono_literals;
using components_test::TestNetwork;
using segue::task::InputPort;
using segue::task::OutputPort;
using segue::type::Value;

constexpr double kVehicleRadius = 0.2;  // m; the components are told a little more

/// The vehicle and its sensors, outside of the network.
struct Vehicle : segue::task::Component {
  OutputPort<messages::Odometry> odometry{*this, "odometry"};
  OutputPort<messages::LaserScan> scan{*this, "scan"};
  InputPort<messages::Twist2D> command{*this, "command"};
  InputPort<messages::Path> path{*this, "path"};
  InputPort<messages::OccupancyGrid> map{*this, "map"};
  InputPort<PlanStatus> status{*this, "status"};
  InputPort<messages::Odometry> estimate{*this, "estimate"};
};

/// A network that gets the pose of the vehicle from odometry without errors.
class Navigation : public ::testing::Test {
 protected:
  static constexpr auto kPeriod = 50ms;

  Navigation() { build(vehicle.odometry); }
  explicit Navigation(const std::string& localization) {
    network.add(localization, "navigation::Localization");
    network.connect(vehicle.odometry, network.input(localization, "odometry"));
    network.connect(vehicle.scan, network.input(localization, "scan"));
    build(network.output(localization, "pose"));
    network.connect(network.output("mapper", "map"), network.input(localization, "map"));
    network.connect(network.output(localization, "pose"), vehicle.estimate);
  }

  void build(segue::task::OutputPortBase& pose_source) {
    network.add("mapper", "navigation::GridMapper",
                Value::map({{"x", -0.5}, {"y", -0.5}, {"width", 9.0}, {"height", 7.0}}));
    network.add("planner", "navigation::PathPlanner");
    network.add("follower", "navigation::PathFollower");
    network.add("explorer", "navigation::FrontierExplorer");
    for (const char* task : {"mapper", "planner", "follower", "explorer"})
      network.connect(pose_source, network.input(task, "pose"));
    for (const char* task : {"mapper", "follower"})
      network.connect(vehicle.scan, network.input(task, "scan"));
    for (const char* task : {"planner", "explorer"})
      network.connect(network.output("mapper", "map"), network.input(task, "map"));
    network.connect(network.output("mapper", "map"), vehicle.map);
    network.connect(network.output("explorer", "goal"), network.input("planner", "goal"));
    network.connect(network.output("planner", "path"), network.input("follower", "path"));
    network.connect(network.output("follower", "progress"), network.input("planner", "progress"));
    network.connect(network.output("planner", "path"), vehicle.path);
    network.connect(network.output("planner", "status"), vehicle.status);
    network.connect(network.output("follower", "command"), vehicle.command);
  }

  /// Lets time pass until `done` or `seconds` are over; whether it was done.
  bool run(double seconds, const std::function<bool()>& done) {
    const double end = network.seconds() + seconds;
    while (network.seconds() < end) {
      step();
      if (done()) return true;
    }
    return false;
  }
  void step() {
    vehicle.command.read(command);
    pose = moved(pose, command, 0.05);
    const messages::Twist2D felt{command.linear * linear_error, command.angular * angular_error};
    odometry = moved(odometry, felt, 0.05);
    closest = std::min(closest, room.clearance({pose.x, pose.y}));
    vehicle.odometry.write({network.seconds(), odometry, felt});
    messages::LaserScan scan = room.scan(pose, 180, 5);
    scan.time = network.seconds();
    vehicle.scan.write(scan);
    network.advance(kPeriod);
  }
  [[nodiscard]] std::string state(const std::string& task) { return network.task(task).state_name(); }
  [[nodiscard]] bool in(const std::string& task, const std::string& name) { return state(task) == name; }

  test::Room room = test::two_rooms();
  Vehicle vehicle;
  TestNetwork network;
  Pose2D pose{1, 1, 0.3};
  Pose2D odometry = pose;
  double linear_error = 1;  ///< of the odometry: how much longer a way seems
  double angular_error = 1;
  messages::Twist2D command;
  double closest = std::numeric_limits<double>::infinity();
};

TEST_F(Navigation, ExploresTwoRoomsThenDrivesToAGoalAndTouchesNothing) {
  for (const char* task : {"mapper", "planner", "follower", "explorer"})
    network.start(task);
  ASSERT_TRUE(run(600, [&] { return in("explorer", "explored"); })) << state("follower") << " at " << pose.x;
  RecordProperty("seconds_until_explored", std::to_string(network.seconds()));

  const auto map = vehicle.map.take();
  ASSERT_TRUE(map);
  const GridFrame frame = frame_of(*map);
  int unseen = 0;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const Point place = frame.centre(frame.cell(i));
    const bool inside = place.x > 0 && place.x < 8 && place.y > 0 && place.y < 6;
    if (inside && room.clearance(place) > 0.3 && map->cells[i] < 0) ++unseen;
  }
  EXPECT_EQ(unseen, 0) << "cells in which the vehicle could stand";

  network.stop("explorer");
  const Value goal = Value::map({{"x", 7.3}, {"y", 0.8}, {"theta", -1.0}});
  ASSERT_TRUE(network.call("planner", "set_goal", Value::map({{"goal", goal}})));
  ASSERT_TRUE(run(120, [&] { return in("planner", "arrived"); })) << state("follower");
  EXPECT_LT(std::hypot(pose.x - 7.3, pose.y - 0.8), 0.12);
  EXPECT_NEAR(pose.theta, -1.0, 0.15);
  EXPECT_GT(closest, kVehicleRadius);
}

/// A vehicle whose odometry is wrong, with a task that corrects it.
class WrongOdometry : public Navigation {
 protected:
  WrongOdometry() : Navigation("localization") {
    linear_error = 1.06;
    angular_error = 1.05;
    for (const char* task : {"localization", "mapper", "planner", "follower"})
      network.start(task);
  }
  [[nodiscard]] double error_of(const Pose2D& believed) const {
    return std::hypot(believed.x - pose.x, believed.y - pose.y);
  }
};

TEST_F(WrongOdometry, IsCorrectedWhileTheMapIsMade) {
  network.start("explorer");
  ASSERT_TRUE(run(600, [&] { return in("explorer", "explored"); })) << state("follower") << " at " << pose.x;
  network.stop("explorer");
  for (const double x : {1.0, 7.3}) {
    const Value goal = Value::map({{"x", x}, {"y", 0.8}, {"theta", -1.0}});
    ASSERT_TRUE(network.call("planner", "set_goal", Value::map({{"goal", goal}})));
    run(1, [] { return false; });
    ASSERT_TRUE(run(120, [&] { return in("follower", "arrived"); })) << state("planner");
    EXPECT_LT(std::hypot(pose.x - x, pose.y - 0.8), 0.25);
  }
  EXPECT_EQ(state("localization"), "localized");
  messages::Odometry estimate;
  vehicle.estimate.read(estimate);
  EXPECT_LT(error_of(estimate.pose), 0.15);
  EXPECT_GT(error_of(odometry), 0.4) << "odometry alone is wrong";
  EXPECT_GT(closest, kVehicleRadius);
  RecordProperty("error_of_estimate_mm", static_cast<int>(1000 * error_of(estimate.pose)));
  RecordProperty("error_of_odometry_mm", static_cast<int>(1000 * error_of(odometry)));
}

TEST_F(WrongOdometry, AnotherTaskGoesOnWithTheCorrection) {
  run(1, [] { return false; });
  const Value moved_by = Value::map({{"x", 3.0}, {"y", 1.5}, {"theta", 0.5}});
  ASSERT_TRUE(network.call("localization", "set_pose", Value::map({{"pose", moved_by}})));
  network.stop("localization");
  const auto saved = network.task("localization").save_state(TestNetwork::soon());
  ASSERT_TRUE(saved && *saved);
  network.add("other", "navigation::Localization");
  network.connect(vehicle.odometry, network.input("other", "odometry"));
  network.connect(network.output("other", "pose"), vehicle.estimate);
  auto& other = network.task("other");
  ASSERT_TRUE(other.configure(TestNetwork::soon()));
  ASSERT_TRUE(other.restore_state(**saved, TestNetwork::soon()));
  ASSERT_TRUE(other.start(TestNetwork::soon()));
  vehicle.estimate.drain();
  run(0.2, [] { return false; });
  EXPECT_EQ(state("other"), "odometry") << "it has no map";
  messages::Odometry estimate;
  vehicle.estimate.read(estimate);
  EXPECT_NEAR(estimate.pose.x, 3, 1e-6);
  EXPECT_NEAR(estimate.pose.theta, 0.5, 1e-6);
}

TEST_F(Navigation, ThePlannerWaitsForTheFirstMap) {
  network.start("planner");
  ASSERT_TRUE(
      network.call("planner", "set_goal", Value::map({{"goal", Value::map({{"x", 3.0}, {"y", 1.0}})}})));
  run(0.5, [] { return false; });
  EXPECT_EQ(state("planner"), "waiting");
  PlanStatus status;
  vehicle.status.read(status);
  EXPECT_NE(status.problem, PlanProblem::None);
  network.start("mapper");
  run(1, [] { return false; });
  EXPECT_EQ(state("planner"), "planned");
}

TEST_F(Navigation, SaysWhyThereIsNoPathAndStands) {
  for (const char* task : {"mapper", "planner", "follower"})
    network.start(task);
  run(1, [] { return false; });
  EXPECT_EQ(state("planner"), "idle");
  ASSERT_TRUE(
      network.call("planner", "set_goal", Value::map({{"goal", Value::map({{"x", 1.0}, {"y", 9.0}})}})));
  run(1, [] { return false; });
  EXPECT_EQ(state("planner"), "no_path");
  PlanStatus status;
  vehicle.status.read(status);
  EXPECT_EQ(status.problem, PlanProblem::GoalOutside);
  EXPECT_EQ(status.goal.y, 9.0);
  EXPECT_EQ(state("follower"), "idle");
  EXPECT_EQ(pose.x, 1);
  const Value no_number = Value::map({{"goal", Value::map({{"x", std::nan("")}})}});
  EXPECT_FALSE(network.call("planner", "set_goal", no_number));

  ASSERT_TRUE(
      network.call("planner", "set_goal", Value::map({{"goal", Value::map({{"x", 3.0}, {"y", 1.0}})}})));
  run(1, [] { return false; });
  EXPECT_EQ(state("planner"), "planned");
  EXPECT_EQ(state("follower"), "driving");
  ASSERT_TRUE(network.call("planner", "clear_goal"));
  run(2, [] { return false; });
  EXPECT_EQ(state("planner"), "idle");
  EXPECT_EQ(state("follower"), "idle");
  EXPECT_EQ(command.linear, 0);
}

/// The follower still tells that it has arrived where it is when the planner gets another goal.
TEST_F(Navigation, ThePlannerHasArrivedAtTheGoalThatItWasGivenLast) {
  for (const char* task : {"mapper", "planner", "follower"})
    network.start(task);
  run(1, [] { return false; });
  for (const double x : {1.0, 3.0, 1.5}) {
    const Value goal = Value::map({{"x", x}, {"y", 1.0}});
    ASSERT_TRUE(network.call("planner", "set_goal", Value::map({{"goal", goal}})));
    EXPECT_NE(state("planner"), "arrived");
    ASSERT_TRUE(run(60, [&] { return in("planner", "arrived"); })) << state("follower");
    EXPECT_NEAR(pose.x, x, 0.15);
    run(2, [] { return false; });
    EXPECT_EQ(state("planner"), "arrived") << "also with later maps";
  }
}

TEST_F(Navigation, TheFollowerWaitsWithoutSensors) {
  network.start("follower");
  OutputPort<messages::Path> path(vehicle, "given_path");
  network.connect(path, network.input("follower", "path"));
  path.write({{3, 1, 0}, {{1, 1, 0}, {3, 1, 0}}});
  run(1, [] { return false; });
  EXPECT_EQ(state("follower"), "driving");
  network.advance(2s);
  EXPECT_EQ(state("follower"), "waiting");
  vehicle.command.read(command);
  EXPECT_EQ(command.linear, 0);
  ASSERT_TRUE(run(30, [&] { return in("follower", "arrived"); })) << "it goes on when they are back";
}

TEST_F(Navigation, TheExplorerGivesUpWhereItCannotGetAhead) {
  network.start("mapper");
  network.start("explorer");
  run(2, [] { return false; });
  EXPECT_EQ(state("explorer"), "exploring");
  ASSERT_TRUE(run(600, [&] { return in("explorer", "explored"); })) << "nobody drives";
  EXPECT_EQ(pose.x, 1);
}

}  // namespace
}  // namespace navigation
