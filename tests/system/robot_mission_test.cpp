// SPDX-License-Identifier: Apache-2.0
// Missions whose actions are controllers of a running robot.
#include <gmock/gmock.h>

#include <fstream>

#include "system_test.hpp"
#include "two_goals.hpp"

namespace segue::testing {
namespace {

using ::testing::HasSubstr;

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

/// Drives by hand: a command that a task keeps until another one comes.
constexpr const char* kByHand = R"(mission: by_hand
actions:
  push:
    inputs: {command: map}
    outputs: {velocity: map}
    outcomes: [moving]
    run:
      controller: drive_only
      write: {drive.command: "{command}"}
      until: [{port: drive.velocity, where: 'forward > 0.1', outcome: moving}, {after: 5min}]
      outputs: {velocity: drive.velocity}
outcomes: [done]
start: push
states: {push: {inputs: {command: {forward: 0.3, turn: 0.0}}, on: {moving: return done}}}
)";

/// Drives to and fro for ever.
constexpr const char* kPatrol = R"(mission: patrol
actions:
  drive_to:
    inputs: {goal: map}
    run:
      controller: go_to
      call: {seeker.set_goal: {goal: "{goal}"}}
      until: [{task: seeker, state: arrived}]
start: drive_to
states:
  drive_to: {inputs: {goal: {x: 0.3, y: 0.0}}, on: {success: drive_back}}
  drive_back: {action: drive_to, inputs: {goal: {x: 0.0, y: 0.0}}, on: {success: drive_to}}
)";

/// Approaches a goal until it is near, which the distance shows, and then drives on.
constexpr const char* kCareful = R"m(mission: careful
observe:
  near(): {port: seeker.distance, where: "value < 0.5"}
  at(goal): {task: seeker, state: arrived, settle: 30s}
  at(sea): {task: seeker, state: stopped, settle: 100ms}
actions:
  approach:
    while: ["!near()"]
    run: {controller: go_to, call: {seeker.set_goal: {goal: {x: 1.0, y: 0.0}}}, until: [{after: 5min}]}
  dock:
    preconditions: ["near()"]
    effects: ["+at(goal)"]
    run: {controller: go_to}
  leave: {preconditions: ["at(goal)"], effects: ["+at(sea)"], run: {controller: go_to}}
outcomes: [done, left_behind]
start: approach
states:
  approach: {on: {success: return left_behind, aborted: dock}}
  dock: {on: {success: leave}}
  leave: {on: {success: return left_behind, aborted: return done}}
)m";

/// Drives to a goal, and does beside that what only begins there.
constexpr const char* kMeets = R"(mission: meets
resources:
  there: {class: module, observe: {task: seeker, state: arrived}}
actions:
  drive:
    run:
      controller: go_to
      call: {seeker.set_goal: {goal: {x: 0.4, y: 0.0}}}
      until: [{task: seeker, state: arrived}]
  greet: {resources: [{exists: there}], run: {simulated: {}}}
  done: {run: {decide: [{outcome: success}]}}
start: both
states:
  both:
    kind: barrier
    states: {greet: {}, drive: {}, done: {kind: decider, on: {success: return success}}}
    on: {success: return success}
)";

class RobotMission : public SystemTest {};

TEST_F(RobotMission, DrivesToItsGoalsInBothModes) {
  start();
  write("drive.yaml", kTwoGoals);
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

TEST_F(RobotMission, ReliesOnFactsThatTheRobotShows) {
  start();
  write("careful.yaml", kCareful);
  for (const std::string mode : {"sequential", "concurrent"}) {
    SCOPED_TRACE(mode);
    EXPECT_EQ(segue({"switch", ""}).status, 0) << "so that the rover is where it began";
    const auto run = json({"mission", "run", "careful.yaml", "--mode", mode});
    EXPECT_EQ(run.find("outcome")->as_string(), "done") << type::to_json(run);
    if (mode == "concurrent") continue;  // its nodes do not say why they aborted
    EXPECT_THAT(type::to_json(run), HasSubstr("since !near() does not hold any more"));
    EXPECT_THAT(type::to_json(run), HasSubstr("expected at(sea), which did not become true within 100ms"));
  }
}

TEST_F(RobotMission, WaitsForUnitsThatTheRobotShows) {
  start();
  write("meets.yaml", kMeets);
  for (const std::string mode : {"sequential", "concurrent"}) {
    SCOPED_TRACE(mode);
    EXPECT_EQ(segue({"switch", ""}).status, 0) << "so that nothing has arrived";
    const auto run = segue({"mission", "run", "meets.yaml", "--mode", mode});
    EXPECT_EQ(run.status, 0) << run.output << run.errors;
    EXPECT_THAT(run.errors,
                HasSubstr("both/greet: waits for 1 unit of the resource 'there', which the robot does not "
                          "show: task 'seeker' is not arrived"));
  }
}

TEST_F(RobotMission, WritesSamplesToPorts) {
  ASSERT_EQ(segue({"init", "rover"}).status, 0);
  write("rover/controllers/drive_only.yaml",
        "network: drive_only\ntasks: {drive: {component: demo::Drive, properties: {timeout: 300s}}}\n");
  start();
  write("by_hand.yaml", kByHand);
  EXPECT_EQ(json({"mission", "run", "by_hand.yaml"}).find("outcome")->as_string(), "done");
  const auto written = segue({"write", "drive.command={forward: 0.0, turn: 0.5}"});
  EXPECT_EQ(written.status, 0) << written.errors;
  EXPECT_THAT(written.output, HasSubstr("drive has read"));
  EXPECT_THAT(segue({"write", "drive.comand=1"}).errors,
              HasSubstr("no input port 'comand', did you mean 'command'?"));
  const auto wrong = segue({"write", "drive.command=fast"});
  EXPECT_EQ(wrong.status, 1);
  EXPECT_THAT(wrong.errors, HasSubstr("error:"));
  EXPECT_EQ(segue({"switch", ""}).status, 0);
  EXPECT_EQ(segue({"write", "drive.command={forward: 0.0, turn: 0.5}"}).status, 1);
}

TEST_F(RobotMission, DoesNotSucceedWithItsControllerTakenAway) {
  start();
  write("endless.yaml", kEndless);
  Process mission(command({"mission", "run", "endless.yaml"}), folder_);
  wait_for_controller("go_to");
  EXPECT_THAT(segue({"status"}).output, HasSubstr("commanded by: segue mission run"));
  const auto refused = segue({"switch", "explore"});
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.output + refused.errors, HasSubstr("the robot is commanded by segue mission run"));
  const auto kept = segue({"apply"});
  EXPECT_EQ(kept.status, 1);
  EXPECT_THAT(kept.output + kept.errors, HasSubstr("or take the robot over (--take-over)"));
  EXPECT_EQ(segue({"switch", "explore", "--take-over"}).status, 0);
  const auto finished = mission.wait();
  EXPECT_EQ(finished.status, 1);
  EXPECT_THAT(finished.errors + finished.output, HasSubstr("endless: aborted"));
  EXPECT_THAT(finished.errors + finished.output, HasSubstr("the robot was taken over by segue switch"));
  EXPECT_EQ(controller(), "explore");
  EXPECT_EQ(segue({"switch", "go_to"}).status, 0) << "nobody commands the robot now";
}

/// A drive that never arrives beside work that needs no robot and ends when the robot has been taken over.
/// Then there is another drive.
constexpr const char* kBesideWork = R"(mission: beside_work
actions:
  drive_to:
    run:
      controller: go_to
      call: {seeker.set_goal: {goal: {x: 1000.0, y: 0.0}}}
      until: [{task: seeker, state: arrived}]
  work:
    resources: [{block: papers}]
    run:
      python:
        text: |
          import os
          def execute(self, inputs, outputs, gvm):
              while not os.path.exists("taken"):
                  if self.preemptive_wait(0.02):
                      return "preempted"
              return "success"
  judge:
    outcomes: [work_alone, other]
    run: {decide: [{when: {drive_to: aborted, work: success}, outcome: work_alone}, {outcome: other}]}
outcomes: [work_alone, other]
start: side_by_side
states:
  side_by_side:
    kind: barrier
    outcomes: [work_alone, other]
    on: {work_alone: again, other: return other}
    states:
      drive_to: {}
      work: {}
      judge: {kind: decider, on: {work_alone: return work_alone, other: return other}}
  again: {action: drive_to, on: {success: return other, aborted: return work_alone}}
)";

TEST_F(RobotMission, DecidesItselfWhatATakenRobotMeansForIt) {
  start();
  write("beside_work.yaml", kBesideWork);
  for (const std::string mode : {"sequential", "concurrent"}) {
    SCOPED_TRACE(mode);
    std::filesystem::remove(folder_ / "taken");
    Process mission(command({"mission", "run", "beside_work.yaml", "--mode", mode}), folder_);
    wait_for_controller("go_to");
    EXPECT_EQ(segue({"switch", "explore", "--take-over"}).status, 0);
    write("taken", "");
    const auto finished = mission.wait();
    EXPECT_THAT(finished.output, HasSubstr("beside_work: work_alone")) << finished.errors;
    EXPECT_EQ(controller(), "explore");
  }
}

TEST_F(RobotMission, IsEndedByFilesThatTakeTheRobotOver) {
  start();
  write("endless.yaml", kEndless);
  Process mission(command({"mission", "run", "endless.yaml"}), folder_);
  wait_for_controller("go_to");
  const auto applied = segue({"apply", "--take-over"});
  EXPECT_EQ(applied.status, 0) << applied.output << applied.errors;
  EXPECT_EQ(mission.wait().status, 1);
  EXPECT_EQ(segue({"apply"}).status, 0) << "nobody commands the robot now";
}

TEST_F(RobotMission, GivesTheRobotBackWhenItIsKilled) {
  start();
  write("endless.yaml", kEndless);
  Process mission(command({"mission", "run", "endless.yaml"}), folder_);
  wait_for_controller("go_to");
  mission.signal(SIGKILL);
  mission.wait();
  EXPECT_TRUE(eventually([&] {
    return segue({"switch", "explore"}).status == 0;
  })) << segue({"status"}).output;
}

/// A task of its own beside the robot's controllers.
constexpr const char* kBeside = R"(network: beside
tasks: {second_odometry: {component: demo::Odometry}}
)";
constexpr const char* kBoth = R"(mission: both
actions:
  drive_to:
    outcomes: [arrived]
    run:
      controller: go_to
      call: {seeker.set_goal: {goal: {x: 0.3, y: 0.0}}}
      until: [{task: seeker, state: arrived}, {after: 5min}]
  look: {run: {controller: beside, until: [{task: second_odometry, state: running, outcome: success}]}}
  explore: {run: {controller: explore, until: [{after: 10ms, outcome: success}]}}
  join: {run: {decide: [{outcome: success}]}}
kind: barrier
states:
  drive_to: {}
  look: {}
  explore: {}
  join: {kind: decider, on: {success: return success}}
)";

TEST_F(RobotMission, RunsControllersAtOnceThatCanAndOthersInTurn) {
  ASSERT_EQ(segue({"init", "rover"}).status, 0);
  write("rover/controllers/beside.yaml", kBeside);
  start();
  write("both.yaml", kBoth);
  EXPECT_EQ(segue({"mission", "run", "both.yaml"}).status, 0);
  const auto history = json({"history"});
  std::vector<std::string> runs;
  for (const auto& one : history.as_list())
    runs.push_back(one.find("to")->as_string());
  EXPECT_THAT(runs, ::testing::Contains("beside+go_to")) << type::to_json(history);
  EXPECT_THAT(runs, ::testing::Contains("beside+explore"));
}

TEST_F(RobotMission, ControllersAreCombinedAndVariedByHandToo) {
  ASSERT_EQ(segue({"init", "rover"}).status, 0);
  write("rover/controllers/beside.yaml", kBeside);
  start();
  EXPECT_EQ(segue({"switch", "go_to+beside", "--set", "seeker.speed=0.1"}).status, 0);
  EXPECT_EQ(controller(), "beside+go_to");
  EXPECT_THAT(segue({"task", "seeker"}).output, HasSubstr("0.1"));
  const auto refused = segue({"switch", "go_to+explore"});
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.errors, HasSubstr("these controllers cannot run at once"));
  EXPECT_THAT(segue({"switch", "go_to+besides"}).errors, HasSubstr("did you mean 'beside'?"));
  EXPECT_THAT(segue({"switch", "go_to", "--set", "speed=1"}).errors,
              HasSubstr("--set must be TASK.PROPERTY=VALUE, got 'speed=1'"));
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
  EXPECT_EQ(controller(), "hold");
}

TEST_F(RobotMission, StopsTheRobotAtOnceEvenWhereItsProgramHearsNothing) {
  start();
  write("endless.yaml", kEndless);
  Process mission(command({"mission", "run", "endless.yaml"}), folder_);
  wait_for_controller("go_to");
  ASSERT_TRUE(eventually([&] { return segue({"mission", "status"}).status == 0; }));
  mission.signal(SIGSTOP);
  EXPECT_THAT(segue({"mission", "stop", "--timeout", "10ms"}).errors, HasSubstr("has not followed yet"));
  wait_for_controller("hold");
  EXPECT_THAT(segue({"switch", "go_to"}).errors, HasSubstr("is commanded by segue mission run"));
  mission.signal(SIGCONT);
  const auto finished = mission.wait();
  EXPECT_EQ(finished.status, 1);
  EXPECT_THAT(finished.output, HasSubstr("endless: preempted"));
  EXPECT_EQ(segue({"switch", "go_to"}).status, 0);
}

TEST_F(RobotMission, IsSeenPausedResumedAndStoppedFromElsewhere) {
  start();
  EXPECT_THAT(segue({"mission", "status"}).errors, HasSubstr("no mission commands the robot"));
  EXPECT_EQ(segue({"mission", "stop"}).status, 1);
  write("patrol.yaml", kPatrol);
  for (const std::string mode : {"sequential", "concurrent"}) {
    SCOPED_TRACE(mode);
    Process mission(command({"mission", "run", "patrol.yaml", "--mode", mode}), folder_);
    wait_for_controller("go_to");
    ASSERT_TRUE(eventually([&] {
      return segue({"mission", "status"}).output.find("mission patrol: running; under way: drive_to") !=
             std::string::npos;
    })) << segue({"mission", "status"}).output;
    EXPECT_EQ(segue({"mission", "pause"}).output, "mission patrol: paused\n");
    EXPECT_EQ(json({"mission", "status"}).find("state")->as_string(), "paused");
    EXPECT_EQ(segue({"mission", "resume"}).output, "mission patrol: running\n");
    EXPECT_THAT(segue({"mission", "stop"}).output,
                ::testing::StartsWith("mission patrol: stopped; the robot is at rest after "));
    EXPECT_EQ(json({"status"}).find("controller")->as_string(), "hold");
    const auto finished = mission.wait();
    EXPECT_EQ(finished.status, 1);
    EXPECT_THAT(finished.output, HasSubstr("patrol: preempted"));
    EXPECT_EQ(segue({"switch", ""}).status, 0);
  }
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

TEST_F(RobotMission, EndsWithARobotThatIsSilentWhichComesToRestWhenItIsBack) {
  start();
  write("endless.yaml", kEndless);
  Process mission(command({"mission", "run", "endless.yaml"}), folder_);
  wait_for_controller("go_to");
  robot_->signal(SIGSTOP);
  const auto finished = mission.wait();
  EXPECT_EQ(finished.status, 1);
  EXPECT_THAT(finished.output, HasSubstr("endless: aborted"));
  EXPECT_THAT(finished.errors, HasSubstr("robot 'rover' did not answer within 10 s, and counts as lost"));
  robot_->signal(SIGCONT);
  wait_for_controller("hold");
}

TEST_F(RobotMission, NeedsARobotThatHasTheController) {
  write("drive.yaml", kTwoGoals);
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
  std::string text = kTwoGoals;
  text.replace(text.find("set_goal"), 8, "set_gaol");
  write("rover/missions/drive.yaml", text);
  const auto checked = segue({"check", "rover/robot.yaml"});
  EXPECT_EQ(checked.status, 1);
  EXPECT_THAT(
      checked.output + checked.errors,
      HasSubstr("drive.yaml:10:31: error: action 'drive_to': in controller 'go_to', task 'seeker' has no "
                "operation 'set_gaol', did you mean 'set_goal'? [unknown-operation]"));
  write("rover/missions/drive.yaml", kTwoGoals);
  EXPECT_EQ(segue({"check", "rover/robot.yaml"}).status, 0);
}

}  // namespace
}  // namespace segue::testing
