// SPDX-License-Identifier: Apache-2.0
//
// The components of the rover together: in virtual time, and as in the example.
#include "../messages/geometry.hpp"
#include "../messages/sensors.hpp"
#include "osmesa_suppressions.hpp"
#include "rover_model.hpp"
#include "test_support.hpp"
#include "types.hpp"

#include <segue/runtime/embedded_robot.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/task_host/task_host.hpp>

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>

namespace rover {
namespace {

using segue::type::Value;
using ::testing::HasSubstr;
using testing::leg;
using testing::soon;
using testing::SteppedRover;
using namespace std::chrono_literals;

Value starting_at(double x, double y, double theta) {
  return Value::map({{"start", Value::map({{"x", x}, {"y", y}, {"theta", theta}})}});
}

/// A rover that drives as a script says.
void add_script(SteppedRover& rover, const Value& legs) {
  rover.add("script", "rover::VelocityScript", Value::map({{"legs", legs}}));
  rover.wire("rover", "time", "script", "time");
  rover.wire("script", "command", "wheels", "command");
}

TEST(RoverDrive, FollowsAScriptAndKnowsWhereItIs) {
  SteppedRover rover(starting_at(0, 0, 0));
  add_script(rover, Value::list({leg(2, 0.4, 0), leg(2, 0.2, 0.5), leg(2, 0.0, -0.8)}));
  rover.start();
  rover.advance(1s);
  EXPECT_EQ(rover.task("wheels").state_name(), "driving");
  EXPECT_EQ(rover.task("script").state_name(), "driving");
  rover.advance(6s);
  EXPECT_EQ(rover.task("script").state_name(), "finished");
  EXPECT_EQ(rover.task("wheels").state_name(), "idle");
  const auto odometry = rover.next<messages::Odometry>("wheels", "odometry");
  const auto pose = rover.next<messages::Odometry>("rover", "pose");
  EXPECT_GT(pose.pose.x, 0.9);
  EXPECT_LT(pose.pose.theta, -0.2);
  EXPECT_NEAR(odometry.pose.x, pose.pose.x, 0.03);
  EXPECT_NEAR(odometry.pose.y, pose.pose.y, 0.03);
  EXPECT_NEAR(odometry.pose.theta, pose.pose.theta, 0.1);
}

TEST(RoverDrive, StopsWhenNoCommandComes) {
  SteppedRover rover(starting_at(0, 0, 0));
  add_script(rover, Value::list({leg(100, 0.2, 0)}));
  rover.start();
  rover.advance(1s);
  ASSERT_TRUE(rover.task("script").stop(soon()));
  rover.advance(1s);
  EXPECT_EQ(rover.task("wheels").state_name(), "idle");
  EXPECT_NEAR(rover.next<messages::Odometry>("rover", "pose").twist.linear, 0, 1e-3);
}

TEST(RoverDrive, StopsAtOnceWhenNobodyIsConnectedThatCouldTellItTo) {
  SteppedRover rover(starting_at(0, 0, 0));
  add_script(rover, Value::list({leg(100, 0.2, 0)}));
  rover.start();
  rover.advance(1s);
  rover.task("wheels").component().find_input("command")->disconnect_all();
  rover.advance(300ms);
  EXPECT_EQ(rover.task("wheels").state_name(), "idle") << "before its timeout";
}

TEST(RoverDrive, StopsAtACommandThatIsNoNumber) {
  SteppedRover rover(starting_at(0, 0, 0));
  segue::task::Component commander;
  segue::task::OutputPort<messages::Twist2D> port(commander, "port");
  ASSERT_TRUE(segue::sample_link::connect(port, *rover.task("wheels").component().find_input("command"), {}));
  rover.start();
  for (int i = 0; i < 20; ++i) {
    port.write({i < 10 ? 0.2 : std::nan(""), 0});
    rover.advance(100ms);
  }
  EXPECT_EQ(rover.task("wheels").state_name(), "idle");
}

TEST(SimulatedWheels, StopWhenTheirDriverIsGone) {
  SteppedRover rover(starting_at(0, 0, 0));
  add_script(rover, Value::list({leg(100, 0.2, 0)}));
  rover.start();
  rover.advance(1s);
  ASSERT_TRUE(rover.task("wheels").stop(soon()));
  rover.advance(100ms);
  EXPECT_NEAR(rover.next<messages::Odometry>("rover", "pose").twist.linear, 0.2, 0.01) << "not at once";
  rover.advance(1s);
  EXPECT_NEAR(rover.next<messages::Odometry>("rover", "pose").twist.linear, 0, 1e-3);
}

TEST(Components, GiveTheSameResultEachTime) {
  const auto run = [] {
    SteppedRover rover(starting_at(0, 0, 0));
    add_script(rover, Value::list({leg(1, 0.4, 0.3)}));
    rover.start();
    rover.call("arm", "move_to", Value::list({Value::list({0.3, -1.2, 1.6, 0.1, 0.2, 0.3})}));
    rover.advance(1500ms);
    return rover.next<SceneState>("rover", "scene").positions;
  };
  EXPECT_EQ(run(), run()) << "to the last bit";
}

TEST(ArmDriver, RefusesWhatItsArmCannotReach) {
  SteppedRover rover(starting_at(0, 0, 0));
  rover.start();
  rover.advance(100ms);
  const auto beyond =
      rover.task("arm").call("move_to", Value::list({Value::list({5, 0, 0, 0, 0, 0})}), soon());
  ASSERT_FALSE(beyond);
  EXPECT_THAT(beyond.error().message, HasSubstr("joint 1"));
  const auto few = rover.task("arm").call("move_to", Value::list({Value::list({0, 0})}), soon());
  ASSERT_FALSE(few);
  EXPECT_THAT(few.error().message, HasSubstr("6 joints, not 2"));
}

TEST(ArmDriver, MovesNoFasterThanItMay) {
  SteppedRover rover(starting_at(0, 0, 0));
  rover.start();
  rover.advance(100ms);
  rover.call("arm", "move_to", Value::list({Value::list({1.5, -1.9, 2.5, 0, 0.6, 0})}));
  rover.advance(1s);
  EXPECT_EQ(rover.task("arm").state_name(), "moving");
  const auto joints = rover.next<messages::JointState>("arm", "joints");
  EXPECT_LT(joints.positions[0], 1.1);
  EXPECT_NEAR(joints.velocities[0], 1.0, 0.1);
  rover.advance(1s);
  EXPECT_EQ(rover.task("arm").state_name(), "holding");
}

/// Joint angles with which the fingers lie flat, their tips at this distance and height as seen from the
/// shoulder.
Value flat_hand_at(double distance, double height) {
  const double upper = kArm[2].place[0];
  const double lower = kArm[3].place[0] + kArm[4].place[0];
  const double wrist = distance - kArm[5].place[0] - kTool[0];
  const double squared = wrist * wrist + height * height;
  const double elbow = M_PI - std::acos((upper * upper + lower * lower - squared) / (2 * upper * lower));
  const double shoulder = std::atan2(-height, wrist) - std::acos((upper * upper + squared - lower * lower) /
                                                                 (2 * upper * std::sqrt(squared)));
  return Value::list({Value::list({0.0, shoulder, elbow, 0.0, -shoulder - elbow, 0.0})});
}

TEST(Gripper, TakesABoxFromTheTable) {
  constexpr double kX = 0.85;
  SteppedRover rover(starting_at(kX, 0, 0));
  rover.start();
  rover.advance(100ms);
  EXPECT_EQ(rover.task("gripper").state_name(), "closed");
  const auto boxes = rover.next<messages::Markers>("rover", "boxes");
  const Eigen::Vector3d box = boxes.markers.at(1).pose.position;
  const double distance = box.x() - kX - kArm[0].place[0];
  const double height = box.z() - kArm[0].place[2] - kArm[1].place[2];
  rover.call("gripper", "open");
  rover.call("arm", "move_to", flat_hand_at(distance - 0.15, height + 0.15));
  rover.advance(4s);
  EXPECT_EQ(rover.task("gripper").state_name(), "open");
  EXPECT_EQ(rover.task("arm").state_name(), "holding");
  for (const double before : {0.08, 0.04, 0.0}) {
    rover.call("arm", "move_to", flat_hand_at(distance - before, height));
    rover.advance(1500ms);
  }
  rover.call("gripper", "close");
  rover.advance(1s);
  EXPECT_EQ(rover.task("gripper").state_name(), "holding");
  rover.call("arm", "stow");
  rover.advance(4s);
  EXPECT_EQ(rover.task("gripper").state_name(), "holding");
  const auto after = rover.next<messages::Markers>("rover", "boxes").markers.at(1).pose.position;
  EXPECT_GT(after.z(), box.z() + 0.03);
  EXPECT_LT(after.x(), box.x() - 0.2) << "the box went along";
  ASSERT_TRUE(rover.task("gripper").stop(soon()));
  rover.advance(1s);
  const auto still = rover.next<messages::Markers>("rover", "boxes").markers.at(1).pose.position;
  EXPECT_LT((still - after).norm(), 0.005) << "the gripper holds although its driver is stopped";
}

TEST(Simulation, PutsABoxElsewhereAsAPersonDoes) {
  SteppedRover rover(starting_at(0.85, 0, 0));
  rover.start();
  rover.advance(100ms);
  const auto pose = [](double x) {
    return Value::map({{"position", Value::list({x, 1.0, 0.05})},
                       {"orientation", Value::map({{"w", 2.0}, {"x", 0.0}, {"y", 0.0}, {"z", 0.0}})}});
  };
  const auto place = [&](int box, double x) {
    return rover.task("rover").call("place_box", Value::list({box, pose(x)}), soon());
  };
  EXPECT_TRUE(place(2, 0.4));
  rover.advance(1s);
  const auto at = rover.next<messages::Markers>("rover", "boxes").markers.at(2).pose.position;
  EXPECT_LT((at.head<2>() - Eigen::Vector2d(0.4, 1)).norm(), 0.01) << "it lies where it was put";
  EXPECT_THAT(to_string(place(3, 0.4).error()), HasSubstr("there are boxes 0 to 2"));
  EXPECT_THAT(to_string(place(0, std::nan("")).error()), HasSubstr("finite numbers"));
}

/// A rover with a battery, whose charge it tells.
double charge_after_driving(double speed) {
  SteppedRover rover(starting_at(0, 0, 0));
  add_script(rover, Value::list({leg(100, speed, 0)}));
  rover.add("battery", "rover::Battery", Value::map({{"capacity", 0.1}}));
  rover.wire("rover", "arm_state", "battery", "arm");
  rover.wire("rover", "wheel_state", "battery", "wheels");
  rover.start();
  rover.advance(4s);
  EXPECT_EQ(rover.task("battery").state_name(), "good");
  return rover.next<BatteryStatus>("battery", "status").charge;
}

TEST(Battery, IsUsedUpByTimeAndByMotion) {
  const double standing = charge_after_driving(0);
  const double driving = charge_after_driving(0.4);
  EXPECT_NEAR(standing, 1 - 4 * 15 / 360.0, 0.01) << "15 W for 4 s, of 360 J";
  EXPECT_LT(driving, standing - 0.001);
  EXPECT_GT(driving, standing - 0.5);
}

TEST(Battery, TellsWhenItIsLowAndWhenItIsEmpty) {
  SteppedRover rover(starting_at(0, 0, 0));
  rover.add("battery", "rover::Battery", Value::map({{"capacity", 0.01}, {"charge", 0.5}}));  // 18 J
  rover.wire("rover", "arm_state", "battery", "arm");
  rover.start();
  rover.advance(500ms);
  EXPECT_EQ(rover.task("battery").state_name(), "good");
  rover.advance(500ms);
  EXPECT_EQ(rover.task("battery").state_name(), "low");
  rover.advance(1s);
  EXPECT_EQ(rover.task("battery").state_name(), "empty");
  EXPECT_EQ(rover.next<BatteryStatus>("battery", "status").charge, 0);
  rover.call("battery", "recharge", Value::list({1.0}));
  rover.advance(20ms);
  EXPECT_EQ(rover.task("battery").state_name(), "good");
  const auto too_much = rover.task("battery").call("recharge", Value::list({1.5}), soon());
  ASSERT_FALSE(too_much);
  EXPECT_THAT(too_much.error().message, HasSubstr("charge must be from 0 to 1"));
}

TEST(StopButton, StaysPressedUntilItIsReleased) {
  SteppedRover rover(starting_at(0, 0, 0));
  rover.add("button", "rover::StopButton");
  rover.start();
  rover.advance(20ms);
  EXPECT_EQ(rover.task("button").state_name(), "released");
  rover.call("button", "press");
  rover.advance(1s);
  EXPECT_EQ(rover.task("button").state_name(), "pressed");
  EXPECT_TRUE(rover.next<bool>("button", "pressed"));
  rover.call("button", "release");
  rover.advance(20ms);
  EXPECT_EQ(rover.task("button").state_name(), "released");
}

TEST(Camera, DeliversNoLargerImagesThanItSays) {
  SteppedRover rover(starting_at(0, 0, 0));
  rover.add("camera", "rover::Camera", Value::map({{"width", 640}, {"height", 480}}));
  auto& camera = rover.task("camera");
  ASSERT_TRUE(camera.cleanup(soon()));
  ASSERT_TRUE(camera.set_properties(Value::map({{"width", 641}}), soon()));
  const auto large = camera.configure(soon());
  ASSERT_FALSE(large);
  EXPECT_THAT(to_string(large.error()), ::testing::HasSubstr("at most 640 x 480"));
}

TEST(Simulation, EndsWhenASetPointIsNoNumber) {
  SteppedRover rover(starting_at(0, 0, 0));
  rover.start();
  rover.advance(100ms);
  segue::task::Component writer;
  segue::task::OutputPort<GripperCommand> port(writer, "port");
  ASSERT_TRUE(segue::sample_link::connect(port, *rover.task("rover").component().find_input("gripper"), {}));
  port.write({0, std::nan("")});
  rover.advance(100ms);
  EXPECT_EQ(rover.task("rover").state(), segue::TaskState::Exception);
  EXPECT_THAT(rover.task("rover").error_message(), HasSubstr("set points"));
}

/// Reads a port until a sample satisfies `enough`; returns that sample, or null after two minutes.
template <class Enough>
Value wait_for(segue::runtime::EmbeddedRobot& robot, const char* port, Enough enough) {
  auto samples = robot.port(port);
  const auto deadline = segue::RealClock::instance().now() + 2min;
  while (segue::RealClock::instance().now() < deadline) {
    auto sample = samples.next(deadline - segue::RealClock::instance().now());
    EXPECT_TRUE(sample) << to_string(sample.error());
    if (!sample) break;
    if (enough(*sample)) return std::move(*sample);
  }
  return {};
}

double number(const Value& value, const char* field) {
  return value.find(field)->as_double();
}

/// The robot of the example, with all its controllers.
class RoverExampleWherePossible : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(std::string(segue::paths::kComponentFolder) +
                                 "/libsegue_components_manipulation.so"))
      GTEST_SKIP() << "its other controllers need Orocos KDL (tools/setup --rover)";
    ::setenv("SEGUE_LIBRARY_PATH", segue::paths::kComponentFolder, 1);
    auto opened =
        segue::runtime::EmbeddedRobot::open(segue::paths::in_sources("/examples/08_rover/robot.yaml"));
    ASSERT_TRUE(opened) << to_string(diagnostics_of(opened.error()));
    robot.emplace(std::move(*opened));
  }
  std::optional<segue::runtime::EmbeddedRobot> robot;
};

/// Others are prepared at most, as those of the halt are always.
std::set<std::string> running_tasks(segue::runtime::EmbeddedRobot& robot) {
  std::set<std::string> names;
  const auto observed = robot.host().observe();
  for (const auto& task : observed.tasks) {
    if (task.state == segue::TaskState::Running) names.insert(task.id.str());
  }
  return names;
}

std::set<std::string> tasks_of(segue::runtime::EmbeddedRobot& robot, const char* controller) {
  std::set<std::string> names;
  if (const auto network = robot.runtime().controller(segue::model::NetworkName(controller))) {
    for (const auto& task : network->tasks)
      names.insert(task.id.str());
  }
  return names;
}

/// The updates of the tasks that all controllers share.
std::map<std::string, std::uint64_t> cycles_of_shared_tasks(segue::runtime::EmbeddedRobot& robot) {
  std::map<std::string, std::uint64_t> cycles;
  for (const auto& task : robot.host().tasks()) {
    for (const char* shared : {"rover", "wheels", "arm", "gripper", "trajectory"}) {
      if (task.id.str() == shared) cycles[shared] = task.timing.cycles;
    }
  }
  return cycles;
}

TEST_F(RoverExampleWherePossible, MakesAllTransitionsBetweenFourControllersWhileItMoves) {
  // Every transition once, each beginning where the last one ended.
  constexpr std::array kWalk = {"explore", "go_to", "explore", "reach", "explore", "teleop", "go_to",
                                "reach",   "go_to", "teleop",  "reach", "teleop",  "explore"};
  std::map<std::string, std::uint64_t> cycles;
  for (const char* controller : kWalk) {
    SCOPED_TRACE(controller);
    const auto result = robot->switch_to(controller);
    ASSERT_EQ(result.outcome, segue::runtime::Outcome::Done) << result.why();
    EXPECT_THAT(robot->runtime().observed_differences(), ::testing::IsEmpty());
    EXPECT_THAT(running_tasks(*robot), ::testing::ContainerEq(tasks_of(*robot, controller)));
    const auto before = std::exchange(cycles, cycles_of_shared_tasks(*robot));
    EXPECT_EQ(cycles.size(), 5U);
    for (const auto& [task, count] : before)
      EXPECT_GE(cycles[task], count) << task << " went on: it would count from zero after a start";
  }
  ASSERT_TRUE(wait_for(*robot, "rover.pose",
                       [](const Value& sample) { return number(*sample.find("twist"), "linear") > 0.1; })
                  .is_map())
      << "it explores again";
  EXPECT_EQ(robot->shut_down().outcome, segue::runtime::Outcome::Done);
}

TEST_F(RoverExampleWherePossible, MovesItsArmWhileItDrives) {
  ASSERT_EQ(robot->switch_to("explore+move_arm").outcome, segue::runtime::Outcome::Done);
  const auto told = robot->host().call(segue::model::TaskId("waypoints"), "go_to",
                                       Value::map({{"name", "raised"}}), soon());
  ASSERT_TRUE(told) << to_string(told.error());
  const auto moves = [](const Value& sample) { return number(*sample.find("twist"), "linear") > 0.1; };
  ASSERT_TRUE(wait_for(*robot, "rover.pose", moves).is_map()) << "it drives";
  const auto raised = wait_for(*robot, "rover.arm_state", [](const Value& sample) {
    return sample.find("positions")->as_list().at(1).as_double() > -0.9;
  });
  ASSERT_TRUE(raised.is_map()) << "the arm arrives";
  EXPECT_EQ(robot->shut_down().outcome, segue::runtime::Outcome::Done);
}

TEST_F(RoverExampleWherePossible, DrivesToTheTableAndSeesTheBoxes) {
  ASSERT_EQ(robot->switch_to("drive").outcome, segue::runtime::Outcome::Done);
  const auto odometry = wait_for(*robot, "wheels.odometry",
                                 [](const Value& sample) { return number(*sample.find("pose"), "x") > 0.7; });
  ASSERT_TRUE(odometry.is_map()) << "it drives to the table";
  ASSERT_EQ(robot->switch_to("look").outcome, segue::runtime::Outcome::Done);
  const auto seen = wait_for(*robot, "detector.markers", [](const Value& sample) {
    return sample.find("markers")->as_list().size() == kBoxes;
  });
  ASSERT_TRUE(seen.is_map()) << "it sees all boxes";
  for (const Value& marker : seen.find("markers")->as_list()) {
    const auto& position = marker.find("pose")->find("position")->as_list();
    EXPECT_NEAR(position.at(2).as_double(), 0.97, 0.1) << "m in front of the camera";
  }
  EXPECT_EQ(robot->shut_down().outcome, segue::runtime::Outcome::Done);
}

}  // namespace
}  // namespace rover
