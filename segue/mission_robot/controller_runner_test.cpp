// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/mission_io.hpp>
#include <segue/mission_engine/engine_test_support.hpp>
#include <segue/mission_robot/controller_runner.hpp>
#include <segue/mission_robot/fake_commanded_robot.hpp>
#include <segue/mission_robot/fake_mending_robot.hpp>

#include <support/logged_lines.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace segue::mission {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using type::Value;

class ControllerActions : public RunningMission {
 protected:
  /// A mission of one action with that 'run'.
  void begin(const std::string& run) {
    const std::string text =
        "mission: m\n"
        "actions:\n"
        "  go:\n"
        "    inputs: {where: {type: text, default: home}}\n"
        "    outputs: {pose: any}\n"
        "    outcomes: [arrived, blocked]\n"
        "    run: {" +
        run +
        "}\n"
        "outcomes: [arrived, blocked]\n"
        "outputs: {pose: any}\n"
        "start: go\n"
        "flows: [go.pose -> outputs.pose]\n"
        "states: {go: {on: {arrived: return arrived, blocked: return blocked}}}\n";
    Runners runners;
    ControllerOptions options;
    options.period = 1ms;
    runners.set_controllers(std::make_shared<ControllerRunner>(robot_, options));
    begin_mission(text, runners);
  }

  std::shared_ptr<FakeCommandedRobot> robot_ = std::make_shared<FakeCommandedRobot>();
};

constexpr const char* kArrived = "until: [{task: planner, state: arrived, outcome: arrived}]";

TEST_F(ControllerActions, TellTheRobotWhatToDoAndWaitForTheEnd) {
  begin(std::string("controller: 'go_{where}', set: {planner.speed: 0.5}, call: {planner.set_goal: {goal: "
                    "'{where}'}}, ") +
        kArrived);
  robot_->wait_until_asked("call planner.set_goal home");
  robot_->become("arrived");
  EXPECT_EQ(ended().outcome_name, "arrived");
  EXPECT_THAT(robot_->asked(),
              ElementsAre("request go_home planner.speed=0.500000", "call planner.set_goal home"));
}

TEST_F(ControllerActions, WriteSamplesAfterTheyCalledOperations) {
  begin(std::string("controller: go_home, call: {planner.reset: {}}, write: {planner.goal: '{where}'}, ") +
        kArrived);
  robot_->wait_until_asked("write planner.goal home");
  robot_->become("arrived");
  EXPECT_EQ(ended().outcome_name, "arrived");
  EXPECT_THAT(robot_->asked(),
              ElementsAre("request go_home", "call planner.reset", "write planner.goal home"));
}

TEST_F(ControllerActions, EndAtOnceWithoutAnEndToWaitFor) {
  begin("controller: go_home");
  EXPECT_EQ(ended().outcome_name, "arrived");
}

TEST_F(ControllerActions, AreNotEndedByWhatATaskSaidBefore) {
  robot_->become("arrived");
  robot_->stand_still();
  begin(
      std::string("controller: go_home, until: [{task: planner, state: arrived, outcome: arrived}, {port: "
                  "planner.status, where: 'value == 1', outcome: blocked}]"));
  robot_->wait_until_asked("open planner.status");
  robot_->show(0);
  robot_->show(1);
  EXPECT_EQ(ended().outcome_name, "blocked");
}

TEST_F(ControllerActions, AskOnceWhetherTheirControllerRunsWhereNothingChanges) {
  begin(std::string("controller: go_home, ") + kArrived);
  robot_->wait_until_polled(1);
  robot_->become("arrived");
  EXPECT_EQ(ended().outcome_name, "arrived");
  EXPECT_EQ(robot_->polls(), 1U);
}

TEST_F(ControllerActions, AskWhetherTheirControllerRunsWhereATaskSaysThatSomethingHasChanged) {
  begin(std::string("controller: go_home, ") + kArrived);
  robot_->wait_until_polled(1);
  robot_->tell_no_changes();
  robot_->take_over();
  robot_->become("arrived");
  EXPECT_EQ(ended().outcome_name, "aborted");
  EXPECT_EQ(robot_->polls(), 2U);
}

TEST_F(ControllerActions, AskAsOftenAsTheirTaskChangesHoweverOftenItUpdates) {
  robot_->stand_still();
  begin(std::string("controller: go_home, ") + kArrived);
  robot_->wait_until_watched(3);  // before it was told, when it was, and for the first update
  for (int i = 0; i < 1000; ++i)
    robot_->update();
  robot_->wait_until_watched(4);
  for (int i = 0; i < 1000; ++i)
    robot_->update();
  robot_->become("turning");
  robot_->wait_until_watched(5);
  robot_->become("arrived");
  EXPECT_EQ(ended().outcome_name, "arrived");
  EXPECT_EQ(robot_->watches(), 5U);
}

TEST_F(ControllerActions, EndByOneTaskAlthoughAnotherOneIsSilent) {
  begin(
      "controller: go_home, until: [{task: silent, state: holding, outcome: blocked}, {task: planner, state: "
      "arrived, outcome: arrived}]");
  robot_->become("arrived");
  EXPECT_EQ(ended().outcome_name, "arrived");
}

TEST_F(ControllerActions, EndByAnAnswerOrByTime) {
  begin("controller: go_home, until: [{call: planner.failed, is: true, outcome: blocked}]");
  robot_->fail_by_call();
  EXPECT_EQ(ended().outcome_name, "blocked");
  begin("controller: go_home, until: [{after: 2ms}]");
  const auto& late = ended();
  EXPECT_EQ(late.outcome_name, "aborted");
  EXPECT_THAT(late.error, HasSubstr("it had not ended after 2ms"));
}

TEST_F(ControllerActions, ReadTheirOutputsFromPorts) {
  begin("controller: go_home, until: [{after: 0s, outcome: arrived}], outputs: {pose: odometry.pose}");
  robot_->wait_until_asked("open odometry.pose");
  robot_->show(7);
  const auto& result = ended();
  EXPECT_EQ(result.outcome_name, "arrived");
  EXPECT_EQ(result.outputs[0], Value(7));
}

TEST_F(ControllerActions, ReadOutputsThatAreWrittenWhileTasksAreTold) {
  begin(
      "controller: go_home, call: {planner.set_goal: {goal: home}}, until: [{after: 0s, outcome: arrived}], "
      "outputs: {pose: odometry.pose}");
  robot_->wait_until_asked("call planner.set_goal home");
  EXPECT_THAT(robot_->asked(),
              ElementsAre("request go_home", "open odometry.pose", "call planner.set_goal home"));
  robot_->show(7);
  EXPECT_EQ(ended().outputs[0], Value(7));
}

TEST_F(ControllerActions, AbortWhereTheRobotRefuses) {
  robot_->refuse();
  begin(std::string("controller: go_home, ") + kArrived);
  EXPECT_EQ(ended().outcome_name, "aborted");
  EXPECT_THAT(engine_->result().error, HasSubstr("refused by the test"));
}

TEST_F(ControllerActions, AbortWhereTheControllerIsLost) {
  begin(std::string("controller: go_home, ") + kArrived);
  robot_->wait_until_asked("request go_home");
  robot_->lose("task 'planner' failed still");
  EXPECT_EQ(ended().outcome_name, "aborted");
  EXPECT_THAT(engine_->result().error,
              HasSubstr("controller 'go_home' was lost: task 'planner' failed still"));
}

TEST_F(ControllerActions, AskWhetherTheirControllerRunsOnlyWhereSomethingHasChanged) {
  begin(std::string("controller: go_home, ") + kArrived);
  robot_->wait_until_polled(1);
  for (int i = 0; i < 10; ++i) {
    const std::size_t before = robot_->watches();
    robot_->become("on leg " + std::to_string(i));
    robot_->wait_until_watched(before + 1);
  }
  EXPECT_EQ(robot_->polls(), 1U);
  robot_->lose("task 'planner' failed still");
  EXPECT_EQ(ended().outcome_name, "aborted");
  EXPECT_EQ(robot_->polls(), 2U);
}

TEST_F(ControllerActions, AbortWhereATaskIsBroken) {
  begin(std::string("controller: go_home, ") + kArrived);
  robot_->wait_until_asked("request go_home");
  robot_->break_task("planner");
  EXPECT_EQ(ended().outcome_name, "aborted");
  EXPECT_THAT(engine_->result().error,
              HasSubstr("controller 'go_home' was lost: task 'planner' is in exception"));
}

TEST_F(ControllerActions, MayWaitForATaskToFail) {
  robot_->break_task("planner");
  begin(
      "controller: go_home, until: [{task: planner, state: exception, outcome: blocked}, {after: 5min, "
      "outcome: "
      "aborted}]");
  robot_->wait_until_asked("request go_home");
  robot_->become("exception");
  EXPECT_EQ(ended().outcome_name, "blocked");
}

TEST_F(ControllerActions, DoNotSucceedWhereAnotherControllerTookOver) {
  begin("controller: go_home, until: [{port: planner.status, where: 'value == 1', outcome: arrived}]");
  robot_->wait_until_asked("open planner.status");
  robot_->switch_away();
  robot_->show(1);
  EXPECT_EQ(ended().outcome_name, "aborted");
  EXPECT_THAT(engine_->result().error, HasSubstr("was lost: the robot runs explore"));
}

TEST_F(ControllerActions, AbortWhereSomebodyTookTheRobotOver) {
  begin(std::string("controller: go_home, ") + kArrived);
  robot_->wait_until_asked("request go_home");
  robot_->take_over();
  EXPECT_EQ(ended().outcome_name, "aborted");
  EXPECT_THAT(engine_->result().error,
              HasSubstr("controller 'go_home' was lost: the robot was taken over by somebody"));
}

TEST_F(ControllerActions, ThatBeginAfterTheRobotWasTakenOverAbortAsThoseUnderWay) {
  robot_->take_over();
  begin(std::string("controller: go_home, ") + kArrived);
  EXPECT_EQ(ended().outcome_name, "aborted");
  EXPECT_THAT(engine_->result().error, HasSubstr("the robot was taken over by somebody"));
}

TEST_F(ControllerActions, ArePreemptedAndStopTheRobotIfTheySaySo) {
  begin("controller: go_home, until: [{task: planner, state: arrived}], afterwards: stop");
  robot_->wait_until_watched(1);  // the action knows that its controller runs
  engine_->stop();
  EXPECT_EQ(ended().outcome_name, "preempted");
  EXPECT_THAT(robot_->asked(), ElementsAre("request go_home", "request"));
}

TEST_F(ControllerActions, NameAController) {
  begin("controller: '{where}/..', until: []");
  EXPECT_EQ(ended().outcome_name, "aborted");
  EXPECT_THAT(engine_->result().error, HasSubstr("'home/..' is not a valid controller name"));
}

class ActionsWhoseTaskIsLost : public ControllerActions {
 protected:
  ActionsWhoseTaskIsLost() { robot_ = mending_; }
  void begin_and_lose(const std::string& until) {
    begin("controller: go_home, call: {planner.set_goal: {goal: home}}, " + until);
    robot_->wait_until_asked("call planner.set_goal home");
    robot_->wait_until_watched(4);  // two before it was told, one for its next update, and one that waits
    mending_->lose_task();
    mending_->wait_until_waited_for();
  }

  const std::shared_ptr<FakeMendingRobot> mending_ = std::make_shared<FakeMendingRobot>();
};

TEST_F(ActionsWhoseTaskIsLost, WaitForItsRepairAndTellItAgain) {
  begin_and_lose(kArrived);
  robot_->become("arrived");
  EXPECT_FALSE(is_over_);
  segue::testing::LoggedLines logged;
  mending_->mend_task();
  EXPECT_EQ(ended().outcome_name, "arrived") << engine_->result().error;
  EXPECT_THAT(robot_->asked(),
              ElementsAre("request go_home", "call planner.set_goal home", "call planner.set_goal home"));
  EXPECT_TRUE(logged.has({"task 'planner' has begun anew"}));
}

TEST_F(ActionsWhoseTaskIsLost, TellItOnceItIsMendedWhereItIsLostWhileItIsBeingTold) {
  mending_->lose_task_at("set_goal");
  begin(std::string("controller: go_home, call: {planner.reset: {}, planner.set_goal: {goal: home}}, ") +
        kArrived);
  mending_->wait_until_waited_for();
  EXPECT_FALSE(is_over_);
  mending_->mend_task();
  robot_->wait_until_asked("call planner.set_goal home");
  robot_->become("arrived");
  EXPECT_EQ(ended().outcome_name, "arrived") << engine_->result().error;
  EXPECT_THAT(robot_->asked(), ElementsAre("request go_home", "call planner.reset", "call planner.reset",
                                           "call planner.set_goal home"))
      << "the new one knows nothing of what its predecessor was told";
}

TEST_F(ActionsWhoseTaskIsLost, AbortAtOnceWhereATaskThatIsNotLostRefuses) {
  mending_->refuse("set_goal");
  begin(std::string("controller: go_home, call: {planner.set_goal: {goal: home}}, ") + kArrived);
  EXPECT_EQ(ended().outcome_name, "aborted");
  EXPECT_THAT(engine_->result().error, HasSubstr("refused by the test"));
}

TEST_F(ActionsWhoseTaskIsLost, AbortWhereTheOneInItsPlaceRefuses) {
  begin_and_lose(kArrived);
  mending_->refuse("set_goal");
  mending_->mend_task();
  EXPECT_EQ(ended().outcome_name, "aborted");
  EXPECT_THAT(engine_->result().error, HasSubstr("refused by the test"));
}

TEST_F(ActionsWhoseTaskIsLost, AbortWhereAnOperationThatWouldEndThemFails) {
  mending_->refuse("failed");
  begin("controller: go_home, until: [{call: planner.failed, is: true, outcome: blocked}]");
  EXPECT_EQ(ended().outcome_name, "aborted");
  EXPECT_THAT(engine_->result().error, HasSubstr("refused by the test"));
}

TEST_F(ActionsWhoseTaskIsLost, AbortWhereItsRepairIsGivenUp) {
  begin_and_lose(kArrived);
  robot_->lose("task 'planner' is gone; 3 attempts have not helped");
  EXPECT_EQ(ended().outcome_name, "aborted");
  EXPECT_THAT(engine_->result().error, HasSubstr("3 attempts have not helped"));
}

TEST_F(ActionsWhoseTaskIsLost, EndMeanwhileWhenTheirOwnTimeIsUp) {
  begin_and_lose(
      "until: [{task: planner, state: arrived, outcome: arrived}, {after: 50ms, outcome: blocked}]");
  EXPECT_EQ(ended().outcome_name, "blocked");
}

}  // namespace
}  // namespace segue::mission
