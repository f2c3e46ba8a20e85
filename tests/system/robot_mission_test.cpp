// SPDX-License-Identifier: Apache-2.0
// Missions whose actions are controllers of a running robot.
#include <gmock/gmock.h>

#include <chrono>
#include <thread>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using ::testing::HasSubstr;

/// Drives to two goals, one after the other.
constexpr const char* kDrive = R"(mission: drive
actions:
  drive_to:
    inputs: {goal: map}
    outputs: {pose: map}
    outcomes: [arrived]
    run:
      controller: go_to
      set: {seeker.speed: 2.0}
      call: {seeker.set_goal: {goal: "{goal}"}}
      until:
        - {task: seeker, state: arrived, outcome: arrived}
        - {after: 5min}
      outputs: {pose: odometry.pose}
outcomes: [done]
outputs: {pose: map}
flows: [second.pose -> outputs.pose]
start: first
states:
  first: {action: drive_to, inputs: {goal: {x: 0.4, y: 0.0}}, on: {arrived: second}}
  second: {action: drive_to, inputs: {goal: {x: 0.4, y: 0.4}}, on: {arrived: return done}}
)";

/// Drives to where it never arrives.
constexpr const char* kEndless = R"(mission: endless
actions:
  drive_to:
    run:
      controller: go_to
      call: {seeker.set_goal: {goal: {x: 1000.0, y: 0.0}}}
      until: [{task: seeker, state: arrived}]
      afterwards: stop
action: drive_to
)";

class RobotMission : public SystemTest {
 protected:
  [[nodiscard]] std::string controller() { return json({"status"}).find("controller")->as_string(); }
  void wait_for_controller(const std::string& name) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (controller() != name) {
      ASSERT_LT(std::chrono::steady_clock::now(), deadline) << "the robot does not run " << name;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
};

TEST_F(RobotMission, DrivesToItsGoalsInBothModes) {
  start();
  write("drive.yaml", kDrive);
  for (const std::string mode : {"sequential", "concurrent"}) {
    SCOPED_TRACE(mode);
    const auto run = json({"mission", "run", "drive.yaml", "--mode", mode});
    EXPECT_EQ(run.find("outcome")->as_string(), "done") << type::to_json(run);
    const auto* outputs = run.find("outputs");
    ASSERT_NE(outputs, nullptr) << type::to_json(run);
    const auto* pose = outputs->find("pose");
    ASSERT_NE(pose, nullptr);
    EXPECT_NEAR(pose->find("x")->as_double(), 0.4, 0.3);
    EXPECT_NEAR(pose->find("y")->as_double(), 0.4, 0.3);
    EXPECT_EQ(controller(), "go_to") << "it runs on until another one is needed";
  }
}

TEST_F(RobotMission, DoesNotSucceedWithItsControllerTakenAway) {
  start();
  write("endless.yaml", kEndless);
  Process mission(command({"mission", "run", "endless.yaml"}), folder_);
  wait_for_controller("go_to");
  EXPECT_EQ(segue({"switch", "explore"}).status, 0);
  const auto finished = mission.wait();
  EXPECT_EQ(finished.status, 1);
  EXPECT_THAT(finished.errors + finished.output,
              HasSubstr("controller 'go_to' was lost: the robot runs controller 'explore'"));
}

TEST_F(RobotMission, IsInterruptedAndStopsTheRobot) {
  start();
  write("endless.yaml", kEndless);
  Process mission(command({"mission", "run", "endless.yaml"}), folder_);
  wait_for_controller("go_to");
  mission.signal(SIGINT);
  const auto finished = mission.wait();
  EXPECT_EQ(finished.status, 1);
  EXPECT_THAT(finished.output, HasSubstr("endless: preempted"));
  EXPECT_EQ(controller(), "");
}

TEST_F(RobotMission, FailsWithItsRobot) {
  start();
  write("endless.yaml", kEndless);
  Process mission(command({"mission", "run", "endless.yaml"}), folder_);
  wait_for_controller("go_to");
  robot_->signal(SIGKILL);
  const auto finished = mission.wait();
  EXPECT_EQ(finished.status, 1) << finished.output << finished.errors;
  EXPECT_THAT(finished.output, HasSubstr("endless: aborted"));
}

TEST_F(RobotMission, NeedsARobotThatHasTheController) {
  write("drive.yaml", kDrive);
  const auto alone = segue({"mission", "run", "drive.yaml"});
  EXPECT_EQ(alone.status, 3);
  EXPECT_THAT(alone.errors, HasSubstr("no robot is running"));
  const auto virtual_time = segue({"mission", "run", "drive.yaml", "--clock", "virtual"});
  EXPECT_EQ(virtual_time.status, 1);
  EXPECT_THAT(virtual_time.errors, HasSubstr("a robot cannot run in virtual time"));
  EXPECT_EQ(segue({"mission", "run", "drive.yaml", "--clock", "virtual", "--simulate"}).status, 0);
  start();
  write("fly.yaml", "mission: fly\nactions: {fly: {run: {controller: fly}}}\naction: fly\n");
  const auto unknown = segue({"mission", "run", "fly.yaml"});
  EXPECT_EQ(unknown.status, 1);
  EXPECT_THAT(unknown.errors + unknown.output, HasSubstr("the request for controller 'fly' was refused"));
}

TEST_F(RobotMission, IsCheckedAgainstTheControllersOfItsRobot) {
  ASSERT_EQ(segue({"init", "rover"}).status, 0);
  std::string text = kDrive;
  text.replace(text.find("set_goal"), 8, "set_gaol");
  write("rover/missions/drive.yaml", text);
  std::ofstream(folder_ / "rover" / "robot.yaml", std::ios::app) << "missions: [missions/*.yaml]\n";
  const auto checked = segue({"check", "rover/robot.yaml"});
  EXPECT_EQ(checked.status, 1);
  EXPECT_THAT(
      checked.output + checked.errors,
      HasSubstr("drive.yaml:10:31: error: action 'drive_to': in controller 'go_to', task 'seeker' has no "
                "operation 'set_gaol', did you mean 'set_goal'? [unknown-operation]"));
  write("rover/missions/drive.yaml", kDrive);
  EXPECT_EQ(segue({"check", "rover/robot.yaml"}).status, 0);
}

}  // namespace
}  // namespace segue::testing
