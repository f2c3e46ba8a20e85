// SPDX-License-Identifier: Apache-2.0
// Scripts that command a robot; what it is asked is noted by a fake.
#include <segue/base/log.hpp>
#include <segue/mission/controllers.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission_engine/engine_test_support.hpp>
#include <segue/mission_robot/fake_commanded_robot.hpp>
#include <segue/mission_robot/fake_mending_robot.hpp>
#include <segue/mission_script/script_robot.hpp>
#include <segue/mission_script/script_runner.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace segue::mission {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using type::Value;

constexpr const char* kUsesGoHome = "controllers: [go_home]";

class RobotScripts : public RunningMission {
 protected:
  void SetUp() override { set_log_level(LogLevel::Error); }
  void TearDown() override { set_log_level(LogLevel::Info); }

  static std::string mission_of(const std::string& body, const std::string& declared) {
    std::string text = "mission: m\nactions:\n  a:\n    outputs: {x: any}\n    " + declared +
                       "\n    run:\n      python:\n        text: |\n"
                       "          def execute(self, inputs, outputs, gvm):\n            ";
    for (const char c : body) {
      text += c;
      if (c == '\n') text += "            ";
    }
    return text + "\naction: a\n";
  }
  void begin(const std::string& body, const std::string& declared = kUsesGoHome) {
    ScriptOptions options;
    if (robot_) {
      options.robot = std::make_shared<ScriptRobot>(
          robot_, std::make_shared<ControllerUnion>(robot_, ControllerUnion::Options{}));
    }
    Runners runners;
    runners.set_scripts(std::make_shared<ScriptRunner>(options));
    begin_mission(mission_of(body, declared), runners);
  }
  const MissionResult& run(const std::string& body, const std::string& declared = kUsesGoHome) {
    begin(body, declared);
    return ended();
  }

  std::shared_ptr<FakeCommandedRobot> robot_ = std::make_shared<FakeCommandedRobot>();
};

TEST_F(RobotScripts, CommandTheRobot) {
  const auto& result =
      run("self.robot.request('go_home', set={'planner.speed': 0.5}, afterwards='stop')\n"
          "self.robot.set('planner.speed', 1.5)\n"
          "self.robot.call('planner.set_goal', {'goal': 'home'})\n"
          "self.robot.write('planner.goal', 'home')\n"
          "task = self.robot.task('planner')\n"
          "outputs['x'] = [task.state, task.state_name, self.robot.call('planner.failed')]\n"
          "return 0");
  EXPECT_EQ(result.outcome, 0) << result.error;
  EXPECT_EQ(result.outputs.front(), Value::list({"running", "driving", false}));
  EXPECT_THAT(robot_->asked(),
              ElementsAre("request go_home planner.speed=0.500000", "set planner.speed 1.500000",
                          "call planner.set_goal home", "write planner.goal home", "request"));
}

TEST_F(RobotScripts, ReadEachSampleOnce) {
  begin(
      "first = self.robot.read('planner.status')\n"
      "try:\n"
      "  self.robot.read('planner.status', timeout=0.001)\n"
      "except self.robot.Timeout as late:\n"
      "  outputs['x'] = [first, str(late)]\n"
      "return 0");
  robot_->wait_until_asked("open planner.status");
  robot_->show(7);
  const auto& result = ended();
  EXPECT_EQ(result.outcome, 0) << result.error;
  EXPECT_EQ(result.outputs.front(),
            Value::list({7, "read planner.status: no sample came from planner.status"}));
}

TEST_F(RobotScripts, WaitForAState) {
  begin(
      "self.robot.request('go_home')\n"
      "outputs['x'] = self.robot.wait_for_state('planner', 'arrived').state_name\n"
      "return 0");
  robot_->wait_until_asked("request go_home");
  robot_->become("arrived");
  const auto& result = ended();
  EXPECT_EQ(result.outcome, 0) << result.error;
  EXPECT_EQ(result.outputs.front(), Value("arrived"));
}

TEST_F(RobotScripts, LookAtATaskAgainWhileTheRobotMendsIt) {
  const auto mending = std::make_shared<FakeMendingRobot>();
  robot_ = mending;
  begin(
      "self.robot.request('go_home')\n"
      "self.robot.task('planner')\n"
      "self.robot.call('planner.set_goal', {'goal': 'home'})\n"
      "outputs['x'] = self.robot.wait_for_state('planner', 'arrived').state_name\n"
      "return 0");
  mending->wait_until_asked("call planner.set_goal home");
  mending->lose_task();
  mending->wait_until_waited_for();
  mending->mend_task();
  mending->become("arrived");
  const auto& result = ended();
  EXPECT_EQ(result.outcome, 0) << result.error;
  EXPECT_EQ(result.outputs.front(), Value("arrived"));
}

TEST_F(RobotScripts, GetTheErrorOfWhatTheyCommandWhereItsTaskIsLost) {
  const auto mending = std::make_shared<FakeMendingRobot>();
  robot_ = mending;
  mending->lose_task_at("set_goal");
  begin(
      "self.robot.request('go_home')\n"
      "try:\n"
      "  self.robot.call('planner.set_goal', {'goal': 'home'})\n"
      "except self.robot.Error as lost:\n"
      "  outputs['x'] = lost.code\n"
      "return 0");
  EXPECT_EQ(ended().outputs.front(), Value("not-found"));
}

TEST_F(RobotScripts, GetErrorsThatSayWhatIsWrong) {
  EXPECT_THAT(
      run("self.robot.request('explore')").error,
      HasSubstr("RobotError: request explore: the action does not declare that it uses the controller "
                "'explore'; add it to its 'controllers'"));
  EXPECT_THAT(run("self.robot.task('arm')").error, HasSubstr("task arm: no task arm runs"));
  EXPECT_THAT(run("self.robot.call('arm')").error, HasSubstr("'arm' is not of the form 'task.name'"));
  EXPECT_THAT(run("self.robot.call(3)").error, HasSubstr("TypeError: expected a text such as 'task.name'"));
  EXPECT_THAT(run("self.robot.call('a.b', timeout=-1)").error, HasSubstr("a timeout is a number of seconds"));
  EXPECT_THAT(run("self.robot.write('a.b', object())").error, HasSubstr("TypeError: a.b: a value of type"));
  EXPECT_THAT(run("self.robot.release('go_home')").error,
              HasSubstr("the action does not use the controller"));
  EXPECT_THAT(run("self.robot.request('go_home', afterwards='kep')").error, HasSubstr("'keep' or 'stop'"));
  EXPECT_THAT(run("self.robot._ask('fly', 'a.b')").error, HasSubstr("a robot has no operation 'fly'"));
  robot_->refuse();
  EXPECT_THAT(run("self.robot.request('go_home')").error, HasSubstr("refused by the test"));
}

TEST_F(RobotScripts, HaveNoRobotUnlessTheyDeclareSo) {
  EXPECT_THAT(run("self.robot", "pure: false").error,
              HasSubstr("RuntimeError: the action does not declare 'controllers'"));
  EXPECT_THAT(run("self.robot.set('a.b', 1)", "sensing: true\n    controllers: []").error,
              HasSubstr("a sensing action can only look at the robot"));
  robot_ = nullptr;
  EXPECT_THAT(run("self.robot", kUsesGoHome).error,
              HasSubstr("there is no robot: the mission runs without one"));
}

TEST_F(RobotScripts, ArePreemptedAtOnceWhereTheyWait) {
  for (const std::string wait :
       {"read('planner.status', timeout=3600)", "wait_for_state('planner', 'arrived')"}) {
    SCOPED_TRACE(wait);
    robot_ = std::make_shared<FakeCommandedRobot>();
    begin("self.robot.request('go_home', afterwards='stop')\nself.robot.call('planner.wait')\nself.robot." +
          wait + "\nreturn 0");
    robot_->wait_until_asked("call planner.wait");
    engine_->stop();
    EXPECT_EQ(ended().outcome_name, "preempted");
    EXPECT_EQ(robot_->asked().back(), "request") << "it stops the robot";
  }
}

TEST_F(RobotScripts, CommandNothingOnceTheyArePreempted) {
  for (const std::string command : {"call('planner.halt')", "set('planner.speed', 1)",
                                    "write('planner.goal', 'x')", "request('go_home')"}) {
    SCOPED_TRACE(command);
    robot_ = std::make_shared<FakeCommandedRobot>();
    begin(
        "try:\n"
        "  self.robot.read('planner.status', timeout=3600)\n"
        "except self.robot.Preempted:\n"
        "  self.robot.task('planner')\n"
        "  self.robot." +
        command + "\nreturn 0");
    robot_->wait_until_asked("open planner.status");
    engine_->stop();
    EXPECT_EQ(ended().outcome_name, "preempted");
    EXPECT_THAT(robot_->asked(), ElementsAre("open planner.status"));
  }
}

TEST_F(RobotScripts, AbortWhereTheirControllerIsLost) {
  begin("self.robot.request('go_home')\nself.preemptive_wait()\nreturn 0");
  robot_->wait_until_asked("request go_home");
  robot_->lose("task 'planner' failed still");
  EXPECT_EQ(ended().outcome_name, "aborted");
  EXPECT_THAT(engine_->result().error,
              HasSubstr("controller 'go_home' was lost: task 'planner' failed still"));
}

TEST_F(RobotScripts, DoNotSucceedWithoutTheirController) {
  begin("self.robot.request('go_home')\nself.robot.call('planner.done')\nself.preemptive_wait()\nreturn 0");
  robot_->wait_until_asked("call planner.done");
  robot_->take_over();
  EXPECT_EQ(ended().outcome_name, "aborted");
  EXPECT_THAT(engine_->result().error,
              HasSubstr("controller 'go_home' was lost: the robot was taken over by somebody"));
}

TEST_F(RobotScripts, GetNoControllerAfterTheRobotWasTakenOver) {
  robot_->take_over();
  begin("self.robot.request('go_home')\nreturn 0");
  EXPECT_EQ(ended().outcome_name, "aborted");
  EXPECT_THAT(engine_->result().error, HasSubstr("the robot was taken over by somebody"));
}

TEST_F(RobotScripts, GiveBackTheControllerWhereTheirProcessDies) {
  const auto& result = run("self.robot.request('go_home', afterwards='stop')\nimport os; os._exit(3)");
  EXPECT_EQ(result.outcome_name, "aborted");
  EXPECT_THAT(result.error, HasSubstr("the Python process"));
  EXPECT_THAT(robot_->asked(), ElementsAre("request go_home", "request"));
}

TEST_F(RobotScripts, MayAskFromManyThreads) {
  const auto& result =
      run("import concurrent.futures\n"
          "with concurrent.futures.ThreadPoolExecutor(16) as pool:\n"
          "  outputs['x'] = sum(pool.map(lambda _: self.robot.call('planner.failed') is False, range(200)))\n"
          "return 0");
  EXPECT_EQ(result.outputs.front(), Value(200)) << result.error;
}

TEST(RobotScriptDeclarations, AreChecked) {
  const auto problems = [](const std::string& declared) {
    Diagnostics diagnostics;
    const auto mission = read_mission(
        "mission: m\nactions:\n  a:\n    " + declared + "\n    run: {python: {text: 'x = 1'}}\naction: a\n",
        "m.yaml", diagnostics);
    return mission ? to_string(validate(*mission)) : to_string(diagnostics);
  };
  EXPECT_EQ(problems("controllers: [go]"), "");
  EXPECT_THAT(problems("pure: true\n    controllers: []"),
              HasSubstr("a script that uses a robot is not pure"));
  EXPECT_THAT(problems("sensing: true\n    controllers: [go]"), HasSubstr("a controller moves the robot"));
  EXPECT_THAT(problems("controllers: ['go_{place}']"), HasSubstr("it uses the input 'place'"));
}

TEST(RobotScriptDeclarations, SurviveWritingAndNeedARobot) {
  Diagnostics diagnostics;
  const std::string text =
      "mission: m\nactions:\n  a: {controllers: [go, 'look'], run: {python: a.py}}\naction: a\n";
  auto mission = read_mission(text, "m.yaml", diagnostics);
  ASSERT_TRUE(mission) << to_string(diagnostics);
  EXPECT_TRUE(needs_robot(*mission));
  const auto again = read_mission(write_mission(*mission), "m.yaml", diagnostics);
  ASSERT_TRUE(again) << to_string(diagnostics);
  EXPECT_EQ(again->actions.front().controllers, mission->actions.front().controllers);
  const ControllerConflicts conflicts{{"go", "look", "stay"}, {{"go", "stay", "task arm"}}};
  claim_controllers(*mission, &conflicts);
  std::vector<std::string> held;
  for (const ResourceUse& use : mission->actions.front().resources)
    held.push_back(use.resource);
  EXPECT_THAT(held, ElementsAre("controller go", "controller look"));
}

}  // namespace
}  // namespace segue::mission
