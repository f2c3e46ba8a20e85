// SPDX-License-Identifier: Apache-2.0
// Missions whose actions are Python scripts that command a running robot.
#include <gmock/gmock.h>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;

/// Drives to a goal and looks whether it is there; beside it, a script looks at the robot only.
constexpr const char* kDrive = R"(mission: drive
actions:
  drive:
    controllers: [go_to]
    outputs: {pose: map, state: text}
    run:
      python:
        text: |
          def execute(self, inputs, outputs, gvm):
              robot = self.robot
              robot.request("go_to", set={"seeker.speed": 2.0}, afterwards="stop")
              robot.call("seeker.set_goal", {"goal": {"x": 0.4, "y": 0.0}})
              outputs["state"] = robot.wait_for_state("seeker", "arrived", timeout=300).state_name
              outputs["pose"] = robot.read("odometry.pose")
              return "success"
outputs: {pose: map, state: text}
flows: [drive.pose -> outputs.pose, drive.state -> outputs.state]
start: drive
states: {drive: {on: {success: return success}}}
)";

/// Writes commands by hand until the task says that it moves, and sets a property while it runs.
constexpr const char* kByHand = R"(mission: by_hand
actions:
  push:
    controllers: [drive_only]
    outputs: {velocity: map}
    run:
      python:
        text: |
          def execute(self, inputs, outputs, gvm):
              self.robot.request("drive_only")
              self.robot.write("drive.command", {"forward": 0.3, "turn": 0.0})
              while True:
                  velocity = self.robot.read("drive.velocity")
                  if velocity["forward"] > 0.1:
                      outputs["velocity"] = velocity
                      return "success"
action: push
)";

constexpr const char* kWrong = R"(mission: wrong
actions:
  wrong:
    controllers: [go_to]
    outputs: {errors: list}
    run:
      python:
        text: |
          def execute(self, inputs, outputs, gvm):
              errors = []
              def attempt(function, *arguments, **more):
                  try:
                      function(*arguments, **more)
                  except self.robot.Error as error:
                      errors.append(str(error))
              attempt(self.robot.call, "seeker.set_goal", {"goal": {"x": 1.0, "y": 0.0}})
              attempt(self.robot.request, "explore")
              self.robot.request("go_to")
              attempt(self.robot.call, "seeker.set_gaol")
              attempt(self.robot.read, "seeker.distanse")
              attempt(self.robot.set, "seeker.sped", 1.0)
              outputs["errors"] = errors
              return "success"
outputs: {errors: list}
flows: [wrong.errors -> outputs.errors]
start: wrong
states: {wrong: {on: {success: return success}}}
)";

constexpr const char* kEndless = R"(mission: endless
actions:
  wait:
    controllers: [go_to]
    run:
      python:
        text: |
          def execute(self, inputs, outputs, gvm):
              self.robot.request("go_to", afterwards="stop")
              self.robot.wait_for_state("seeker", "arrived")
              return "success"
action: wait
)";

class RobotScript : public SystemTest {};

TEST_F(RobotScript, DrivesTheRobotInBothModes) {
  ASSERT_EQ(segue({"init", "rover"}).status, 0);
  write("rover/controllers/drive_only.yaml",
        "network: drive_only\ntasks: {drive: {component: demo::Drive, properties: {timeout: 300s}}}\n");
  start();
  write("drive.yaml", kDrive);
  write("by_hand.yaml", kByHand);
  for (const std::string mode : {"sequential", "concurrent"}) {
    SCOPED_TRACE(mode);
    const auto run = json({"mission", "run", "drive.yaml", "--mode", mode});
    const auto* outputs = run.find("outputs");
    ASSERT_NE(outputs, nullptr) << type::to_json(run);
    EXPECT_EQ(*outputs->find("state"), type::Value("arrived"));
    EXPECT_NEAR(outputs->find("pose")->find("x")->as_double(), 0.4, 0.3);
    EXPECT_EQ(controller(), "");
    EXPECT_EQ(segue({"mission", "run", "by_hand.yaml", "--mode", mode}).status, 0);
    EXPECT_EQ(controller(), "drive_only") << "it runs on until another one is needed";
  }
}

TEST_F(RobotScript, IsToldWhatIsWrong) {
  write("wrong.yaml", kWrong);
  const auto alone = segue({"mission", "run", "wrong.yaml"});
  EXPECT_NE(alone.status, 0) << "there is no robot";
  EXPECT_EQ(segue({"mission", "run", "wrong.yaml", "--simulate"}).status, 0);
  start();
  const auto run = json({"mission", "run", "wrong.yaml"});
  const auto* outputs = run.find("outputs");
  ASSERT_NE(outputs, nullptr) << type::to_json(run);
  const auto errors = outputs->find("errors")->as_list();
  ASSERT_EQ(errors.size(), 5U) << type::to_json(run);
  EXPECT_THAT(errors[0].as_string(), HasSubstr("call seeker.set_goal: "));
  EXPECT_THAT(errors[1].as_string(), HasSubstr("does not declare that it uses the controller 'explore'"));
  EXPECT_THAT(errors[2].as_string(), HasSubstr("did you mean 'set_goal'?"));
  EXPECT_THAT(errors[3].as_string(), HasSubstr("did you mean 'distance'?"));
  EXPECT_THAT(errors[4].as_string(), HasSubstr("did you mean 'speed'?"));
}

TEST_F(RobotScript, IsPreemptedAndGivesTheRobotBack) {
  start();
  write("endless.yaml", kEndless);
  Process stopped(command({"mission", "run", "endless.yaml"}), folder_);
  wait_for_controller("go_to");
  stopped.signal(SIGINT);
  EXPECT_EQ(stopped.wait().status, 1);
  EXPECT_THAT(controller(), AnyOf("", "hold")) << "whichever comes first, the end of the script or the halt";
  Process disturbed(command({"mission", "run", "endless.yaml"}), folder_);
  wait_for_controller("go_to");
  EXPECT_EQ(segue({"switch", "explore", "--take-over"}).status, 0);
  const auto finished = disturbed.wait();
  EXPECT_EQ(finished.status, 1);
  EXPECT_THAT(finished.errors + finished.output, HasSubstr("endless: aborted"));
  EXPECT_THAT(finished.errors + finished.output, HasSubstr("the robot was taken over by segue switch"));
  EXPECT_EQ(controller(), "explore") << "it no more stops what others run";
}

}  // namespace
}  // namespace segue::testing
