// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <set>
#include <sstream>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using type::Value;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

using RunningRobot = SystemTest;

/// One JSON document, or one on each line.
void expect_json(const std::string& output, const std::string& what) {
  EXPECT_FALSE(output.empty()) << what;
  if (type::parse_json(output)) return;
  std::istringstream lines(output);
  for (std::string line; std::getline(lines, line);)
    EXPECT_TRUE(type::parse_json(line)) << what << ": " << line;
}

TEST_F(RunningRobot, ItSwitchesAndStopsCleanly) {
  start({"--controller", "explore"});
  ASSERT_TRUE(robot_->wait_for("explore"));
  const auto result = json({"switch", "go_to"});
  EXPECT_EQ(result.find("outcome")->as_string(), "done");
  EXPECT_EQ(result.find("to")->as_string(), "go_to");
  EXPECT_GT(result.find("actions")->as_list().size(), 0U);
  for (const Value& action : result.find("actions")->as_list()) {
    EXPECT_EQ(action.find("outcome")->as_string(), "done");
  }
  const auto status = json({"status"});
  EXPECT_EQ(status.find("controller")->as_string(), "go_to");
  EXPECT_EQ(status.find("tasks")->as_list().size(), 5U);
  for (const Value& task : status.find("tasks")->as_list()) {
    EXPECT_EQ(task.find("state")->as_string(), "running") << type::to_json(task);
  }
  EXPECT_TRUE(status.find("differences")->as_list().empty());
  const auto ended = stop();
  EXPECT_EQ(ended.status, 0) << ended.errors;
  EXPECT_TRUE(contains(ended.output, "the robot is stopped")) << ended.output;
  EXPECT_EQ(segue({"status"}).status, 3);
}

TEST_F(RunningRobot, ItSwitchesToTheEmptyNetwork) {
  start({"--controller", "explore"});
  EXPECT_EQ(json({"switch", "manual"}).find("outcome")->as_string(), "done");
  EXPECT_EQ(json({"switch", "empty"}).find("outcome")->as_string(), "done");
  EXPECT_TRUE(json({"status"}).find("tasks")->as_list().empty());
}

TEST_F(RunningRobot, ADryRunShowsTheTransitionAndDoesNothing) {
  start();
  const auto plan = json({"switch", "explore", "--dry-run"});
  EXPECT_EQ(*plan.find("counts")->find("start"), Value(4));
  EXPECT_EQ(json({"status"}).find("controller")->as_string(), "");
  const auto text = segue({"switch", "explore", "--dry-run", "--order", "paper"});
  EXPECT_TRUE(contains(text.output, "order paper")) << text.output;
  EXPECT_TRUE(contains(text.output, "task 'odometry' is added")) << text.output;
}

TEST_F(RunningRobot, ItExecutesATransitionFile) {
  start({"--controller", "explore"});
  ASSERT_EQ(segue({"switch", "explore"}).status, 0);
  write("t.yaml",
        "transition:\n  from: explore\n  to: explore\n  actions:\n"
        "    - {id: 1, kind: stop, task: odometry}\n"
        "    - {id: 2, kind: call_operation, task: odometry, operation: reset, after: [1]}\n"
        "    - {id: 3, kind: start, task: odometry, after: [2]}\n");
  const auto result = json({"switch", "--transition", "t.yaml"});
  EXPECT_EQ(result.find("outcome")->as_string(), "done");
  ASSERT_EQ(result.find("actions")->as_list().size(), 3U);
  EXPECT_EQ(result.find("actions")->as_list()[1].find("kind")->as_string(), "call_operation");
  const auto text = segue({"switch", "--transition", "t.yaml"});
  EXPECT_EQ(text.status, 0) << text.errors;
  EXPECT_TRUE(contains(text.output, "explore -> explore: done, 3 actions")) << text.output;
  EXPECT_TRUE(json({"status"}).find("differences")->as_list().empty());
}

TEST_F(RunningRobot, AWrongTransitionFileIsExplained) {
  start({"--controller", "explore"});
  ASSERT_EQ(segue({"switch", "explore"}).status, 0);
  write("bad.yaml", "transition:\n  actions: 3\n");
  const auto bad = segue({"switch", "--transition", "bad.yaml"});
  EXPECT_EQ(bad.status, 1);
  EXPECT_TRUE(contains(bad.errors, "bad.yaml:2")) << bad.errors;
  write("early.yaml",
        "transition: {from: explore, to: explore, actions: [{id: 1, kind: cleanup, task: odometry}]}\n");
  const auto early = json({"switch", "--transition", "early.yaml"}, 1);
  EXPECT_EQ(early.find("outcome")->as_string(), "refused");
  const auto nowhere = segue({"switch", "--transition", "nowhere.yaml"});
  EXPECT_EQ(nowhere.status, 1);
  EXPECT_TRUE(contains(nowhere.errors, "nowhere.yaml")) << nowhere.errors;
}

TEST_F(RunningRobot, ItsBeliefCanBeReset) {
  start({"--controller", "manual"});
  ASSERT_EQ(segue({"switch", "manual"}).status, 0);
  ASSERT_EQ(segue({"set", "drive.max_speed=0.25"}).status, 0);
  const auto drift = json({"status"}).find("differences")->as_list();
  ASSERT_EQ(drift.size(), 1U);
  EXPECT_TRUE(contains(drift[0].as_string(), "task 'drive': property 'max_speed' is 0.25, expected "))
      << drift[0].as_string();
  EXPECT_EQ(json({"reset-belief"}).find("outcome")->as_string(), "done");
  // On a busy computer tasks may not answer for a while.
  EXPECT_TRUE(eventually([&] { return json({"status"}).find("differences")->as_list().empty(); }))
      << segue({"status"}).output;
  EXPECT_TRUE(contains(segue({"reset-belief"}).output, "the observed state"));
}

TEST_F(RunningRobot, ItsBeliefCanBeReplacedByAGivenNetwork) {
  start({"--controller", "manual"});
  ASSERT_EQ(segue({"switch", "manual"}).status, 0);
  write("more.yaml", "network: more\ntasks: {ghost: {component: \"demo::Drive\"}}\n");
  EXPECT_TRUE(contains(segue({"reset-belief", "--network", "more.yaml"}).output, "'more.yaml'"));
  EXPECT_TRUE(eventually([&] {
    const auto drift = type::to_json(*json({"status"}).find("differences"));
    return contains(drift, "task 'ghost' is missing");
  })) << segue({"status"}).output;
  EXPECT_EQ(json({"reset-belief"}).find("outcome")->as_string(), "done");
  write("bad.yaml", "network: bad\ntasks: {a: {component: \"x::A\", colour: red}}\n");
  const auto refused = segue({"reset-belief", "--network", "bad.yaml"});
  EXPECT_EQ(refused.status, 1);
  EXPECT_TRUE(contains(refused.errors, "colour")) << refused.errors;
  EXPECT_EQ(segue({"reset-belief", "--network", "none.yaml"}).status, 1);
}

TEST_F(RunningRobot, ASampleIsOneLine) {
  start({"--controller", "manual"});
  ASSERT_EQ(segue({"switch", "manual"}).status, 0);
  const auto samples = segue({"read", "odometry.pose", "--count", "20"});
  EXPECT_EQ(samples.status, 0) << samples.errors;
  std::istringstream lines(samples.output);
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    EXPECT_EQ(line.rfind("{x: ", 0), 0U) << line;
    EXPECT_TRUE(contains(line, ", y: ") && contains(line, ", theta: ") && line.back() == '}') << line;
  }
  EXPECT_EQ(count, 20);
}

TEST_F(RunningRobot, ItsTasksCanBeInspectedAndChanged) {
  start({"--controller", "manual"});
  ASSERT_EQ(segue({"switch", "manual"}).status, 0);
  EXPECT_EQ(json({"task", "drive"}).find("component")->as_string(), "demo::Drive");
  const auto samples = segue({"read", "odometry.pose", "--count", "3", "--format", "json"});
  EXPECT_EQ(samples.status, 0) << samples.errors;
  EXPECT_EQ(std::count(samples.output.begin(), samples.output.end(), '\n'), 3);
  const auto first = type::parse_json(samples.output.substr(0, samples.output.find('\n')));
  ASSERT_TRUE(first);
  EXPECT_NE(first->find("theta"), nullptr);
  const auto set = segue({"set", "drive.max_speed=0.25"});
  EXPECT_EQ(set.status, 0) << set.errors;
  EXPECT_EQ(*json({"task", "drive"}).find("properties")->find("max_speed"), Value(0.25));
  const Value task = json({"task", "drive"});
  std::int64_t updates = 0;
  for (const Value& bin : task.find("histograms")->find("updates")->find("bins")->as_list())
    updates += bin.find("count")->as_int();
  EXPECT_GT(updates, 0);
  const auto shown = segue({"task", "drive"});
  EXPECT_TRUE(contains(shown.output, ", 99 % within ")) << shown.output;
  EXPECT_TRUE(contains(shown.output, "LATENCIES")) << shown.output;
  const auto called = segue({"call", "joystick.push", "forward=0.5", "turn=0"});
  EXPECT_EQ(called.status, 0) << called.errors;
  EXPECT_EQ(segue({"call", "joystick.push", "0.5", "0"}).status, 0);
  EXPECT_EQ(segue({"call", "odometry.reset"}).status, 0);
  const auto looked = segue({"task", "odometry"});
  EXPECT_TRUE(contains(looked.output, " info: the pose was reset\n")) << looked.output;
  EXPECT_EQ(json({"task", "odometry"}).find("log")->as_list().back().find("level")->as_string(), "info");
  EXPECT_EQ(segue({"read", "odometry.pose", "--for", "200ms"}).status, 0);
}

TEST_F(RunningRobot, LatenciesOfItsConnectionsAreMeasured) {
  ASSERT_EQ(segue({"init", "rover"}).status, 0);
  std::ofstream(folder_ / "rover/controllers/explore.yaml", std::ios::app)
      << "deployments:\n  sensors: {process: sensors, tasks: [odometry]}\n";
  start({"--controller", "explore"});
  wait_for_controller("explore");
  // Between two processes in both directions, and within one.
  std::set<std::string> missing = {"drive.velocity", "odometry.pose", "wanderer.command"};
  const bool all = eventually([&] {
    const Value status = json({"status"});
    for (const Value& connection : status.find("connections")->as_list()) {
      if (connection.find("measured")->as_int() == 0) continue;
      EXPECT_GT(connection.find("latency_us")->as_double(), 0);
      EXPECT_GE(connection.find("latency_worst_us")->as_double(), connection.find("latency_us")->as_double());
      missing.erase(connection.find("from")->as_string());
    }
    return missing.empty();
  });
  EXPECT_TRUE(all) << ::testing::PrintToString(missing);
  EXPECT_TRUE(contains(segue({"status"}).output, "LATENCY"));
}

TEST_F(RunningRobot, MistakesAreExplained) {
  start({"--controller", "manual"});
  ASSERT_EQ(segue({"switch", "manual"}).status, 0);
  const auto controller = segue({"switch", "manaul"});
  EXPECT_EQ(controller.status, 1);
  EXPECT_TRUE(contains(controller.errors, "did you mean 'manual'?")) << controller.errors;
  const auto task = segue({"task", "drvie"});
  EXPECT_EQ(task.status, 1);
  EXPECT_TRUE(contains(task.errors, "did you mean 'drive'?")) << task.errors;
  EXPECT_EQ(segue({"read", "drive.velocty"}).status, 1);
  EXPECT_EQ(segue({"read", "drvie.velocity"}).status, 1);
  EXPECT_EQ(segue({"read", "drive"}).status, 1);
  EXPECT_EQ(segue({"set", "drive.max_speed=fast"}).status, 1);
  EXPECT_EQ(segue({"set", "drive.max_spede=1"}).status, 1);
  EXPECT_EQ(segue({"set", "drive.max_speed"}).status, 2);
  EXPECT_EQ(segue({"call", "joystick.push", "forward=1"}).status, 1);
  EXPECT_EQ(segue({"call", "joystick.pull"}).status, 1);
  EXPECT_EQ(segue({"status", "--robot", "rvoer"}).status, 3);
  EXPECT_EQ(json({"task", "nothing"}, 1).find("error")->find("code")->as_string(), "not-found");
}

TEST_F(RunningRobot, EventsAndHistoryReportItsSwitches) {
  start({"--controller", "explore"});
  ASSERT_EQ(segue({"switch", "manual"}).status, 0);
  const auto events = json({"events"});
  std::int64_t last = 0;
  for (const Value& event : events.as_list()) {
    EXPECT_EQ(event.find("number")->as_int(), last + 1);
    last = event.find("number")->as_int();
  }
  EXPECT_GT(last, 5);
  EXPECT_EQ(json({"events", "--after", std::to_string(last - 1)}).as_list().size(), 1U);
  const auto history = json({"history"});
  EXPECT_EQ(history.as_list().back().find("to")->as_string(), "manual");
  EXPECT_TRUE(contains(segue({"history"}).output, "explore -> manual: done")) << segue({"history"}).output;
  const auto top = segue({"top"});
  EXPECT_EQ(top.status, 0);
  EXPECT_TRUE(contains(top.output, "joystick")) << top.output;
  EXPECT_TRUE(contains(top.output, " CPU")) << top.output;
  EXPECT_GT(json({"top"}).find("tasks")->as_list().front().find("cpu_us")->as_double(), 0.0);
  EXPECT_FALSE(contains(top.output, "\x1b"));
  Process follower(command({"events", "--follow"}), folder_);
  ASSERT_TRUE(follower.wait_for("manual"));
  ASSERT_EQ(segue({"switch", "go_to"}).status, 0);
  EXPECT_TRUE(follower.wait_for("go_to"));
}

TEST_F(RunningRobot, AFollowedPortSurvivesItsReader) {
  start({"--controller", "explore"});
  ASSERT_EQ(segue({"switch", "explore"}).status, 0);
  Process reader(command({"read", "odometry.pose", "--follow", "--format", "json"}), folder_);
  ASSERT_TRUE(reader.wait_for("theta"));
  reader.signal(SIGKILL);
  EXPECT_EQ(reader.wait().status, 128 + SIGKILL);
  EXPECT_EQ(segue({"read", "odometry.pose"}).status, 0);
  EXPECT_EQ(stop(SIGTERM).status, 0);
}

TEST_F(RunningRobot, WhatFollowsEndsWithItsReader) {
  start({"--controller", "explore"});
  write("runtime/segue/rover/drivers.log", "begins\n");
  const std::vector<std::pair<std::vector<std::string>, std::string>> followers = {
      {{"events", "--follow"}, "explore"},             // then nothing
      {{"log", "drivers", "--follow"}, "begins"},      // then nothing
      {{"read", "odometry.pose", "--follow"}, "x"},    // more than anybody reads
      {{"read", "odometry.pose", "--for", "1h"}, "x"}  // likewise
  };
  for (const auto& [arguments, first] : followers) {
    Process follower(command(arguments), folder_);
    ASSERT_TRUE(follower.wait_for(first)) << arguments[0];
    follower.close_output();
    EXPECT_EQ(follower.wait().status, 0) << arguments[0] << ": -1 says that it had to be killed";
  }
}

TEST_F(RunningRobot, AReaderIsNotifiedOfTheEndOfItsRobot) {
  start({"--controller", "explore"});
  ASSERT_EQ(segue({"switch", "explore"}).status, 0);
  Process reader(command({"read", "odometry.pose", "--follow", "--format", "json"}), folder_);
  ASSERT_TRUE(reader.wait_for("theta"));
  robot_->signal(SIGKILL);
  robot_->wait();
  const auto finished = reader.wait();
  EXPECT_EQ(finished.status, 3) << finished.errors;
  EXPECT_TRUE(contains(finished.errors, "gone")) << finished.errors;
}

TEST_F(RunningRobot, TheSocketOfAKilledRuntimeIsReplaced) {
  start();
  robot_->signal(SIGKILL);
  robot_->wait();
  EXPECT_TRUE(std::filesystem::exists(folder_ / "runtime/segue/rover.sock"));
  EXPECT_EQ(segue({"status", "--robot", "rover"}).status, 3);
  start();
  EXPECT_EQ(segue({"status", "--robot", "rover"}).status, 0);
}

TEST_F(RunningRobot, TheSameRobotTwiceIsRefused) {
  start();
  const auto second = segue({"run", "rover/robot.yaml"});
  EXPECT_EQ(second.status, 1);
  EXPECT_TRUE(contains(second.errors, "another runtime controls this robot")) << second.errors;
  EXPECT_EQ(segue({"status"}).status, 0);
}

TEST_F(RunningRobot, TwoRobotsAreDistinguishedByName) {
  start();
  ASSERT_EQ(segue({"init", "other"}).status, 0);
  Process other(command({"run", "other/robot.yaml"}), folder_);
  ASSERT_TRUE(other.wait_for("robot other runs"));
  const auto unclear = segue({"status"});
  EXPECT_EQ(unclear.status, 2);
  EXPECT_TRUE(contains(unclear.errors, "--robot")) << unclear.errors;
  EXPECT_EQ(json({"status", "--robot", "other"}).find("robot")->as_string(), "other");
}

TEST_F(RunningRobot, RunEndsAfterItsTime) {
  ASSERT_EQ(segue({"init", "rover"}).status, 0);
  const auto finished = segue({"run", "rover/robot.yaml", "--controller", "explore", "--for", "300ms"});
  EXPECT_EQ(finished.status, 0) << finished.errors;
  const auto up = finished.output.find("time is up");
  ASSERT_NE(up, std::string::npos) << finished.output;
  EXPECT_LT(finished.output.find("explore: now runs"), up) << "behind what was before:\n" << finished.output;
}

TEST_F(RunningRobot, RunInJsonPrintsOneEventALine) {
  ASSERT_EQ(segue({"init", "rover"}).status, 0);
  const auto finished =
      segue({"run", "rover/robot.yaml", "--controller", "explore", "--for", "100ms", "--format", "json"});
  ASSERT_EQ(finished.status, 0) << finished.errors;
  std::istringstream lines(finished.output);
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count)
    EXPECT_TRUE(type::parse_json(line)) << line;
  EXPECT_GT(count, 5);
}

/// The verbs that talk to a running robot, as the completion script knows them.
std::vector<std::string> verbs_with_robot(const std::string& script) {
  std::vector<std::string> verbs;
  std::istringstream lines(script);
  for (std::string line; std::getline(lines, line);) {
    const auto bracket = line.find(") words=");
    if (bracket != std::string::npos && contains(line, "--robot "))
      verbs.push_back(line.substr(4, bracket - 4));
  }
  return verbs;
}

TEST_F(RunningRobot, EveryVerbThatTalksToItPrintsJson) {
  ASSERT_EQ(segue({"init", "rover"}).status, 0);
  std::ofstream(folder_ / "rover/controllers/manual.yaml", std::ios::app)
      << "deployments:\n  hands: {process: hands, tasks: [joystick]}\n";
  start({"--controller", "manual"});
  ASSERT_EQ(segue({"switch", "manual"}).status, 0);
  write("t.yaml", "transition: {from: manual, to: manual, actions: []}\n");
  write("n.yaml", "network: sent\ntasks: {drive: {component: \"demo::Drive\"}}\n");
  const std::vector<std::vector<std::string>> lines = {{"status"},
                                                       {"top", "--once"},
                                                       {"task", "drive"},
                                                       {"chain", "odometry", "drive"},
                                                       {"graph"},
                                                       {"hz", "odometry", "-n", "1", "--every", "100ms"},
                                                       {"bw", "odometry.pose", "-n", "1", "--every", "100ms"},
                                                       {"delay", "odometry"},
                                                       {"read", "odometry.pose"},
                                                       {"read", "odometry.pose", "-n", "3"},
                                                       {"plot", "odometry.pose", "-n", "3"},
                                                       {"set", "drive.max_speed=0.25"},
                                                       {"call", "joystick.push", "forward=1", "turn=0"},
                                                       {"repair"},
                                                       {"restart", "odometry"},
                                                       {"reset-belief"},
                                                       {"units"},
                                                       {"log", "hands"},
                                                       {"prepare", "explore"},
                                                       {"prepare"},
                                                       {"plan"},
                                                       {"plan", "explore"},
                                                       {"apply"},
                                                       {"switch", "explore", "--dry-run"},
                                                       {"switch", "--network", "n.yaml", "--dry-run"},
                                                       {"switch", "--network", "n.yaml"},
                                                       {"switch", "manual"},
                                                       {"switch", "--transition", "t.yaml"},
                                                       {"switch", "manual", "--no-wait", "--timeout", "1ms"},
                                                       {"events"},
                                                       {"events", "--after", "3"},
                                                       {"history"},
                                                       {"history", "-n", "1"},
                                                       {"history", "--all"},
                                                       {"history", "--differences"},
                                                       {"history", "--versions"},
                                                       {"diff", "n.yaml", "n.yaml", "--estimate"}};
  std::set<std::string> tried;
  for (auto arguments : lines) {
    tried.insert(arguments.front());
    arguments.insert(arguments.end(), {"--robot", "rover", "--format", "json"});
    const auto finished = segue(arguments);
    EXPECT_EQ(finished.status, 0) << arguments.front() << ' ' << finished.errors << finished.output;
    expect_json(finished.output, arguments.front());
  }
  for (const std::string& verb : verbs_with_robot(segue({"completion", "bash"}).output))
    EXPECT_TRUE(tried.contains(verb)) << "nothing was tried of " << verb;
}

TEST_F(RunningRobot, WhatFailsPrintsJsonToo) {
  start({"--controller", "manual"});
  ASSERT_EQ(segue({"switch", "manual"}).status, 0);
  const std::vector<std::vector<std::string>> lines = {{"task", "drvie"},
                                                       {"read", "odometry.pse"},
                                                       {"set", "drive.max_speed=fast"},
                                                       {"call", "drive.fly"},
                                                       {"prepare", "nothing"},
                                                       {"plan", "nothing"},
                                                       {"switch", "nothing"},
                                                       {"switch", "--network", "no.yaml"},
                                                       {"switch", "--transition", "no.yaml"},
                                                       {"log", "no_process"}};
  for (auto arguments : lines) {
    arguments.insert(arguments.end(), {"--format", "json"});
    const auto finished = segue(arguments);
    EXPECT_EQ(finished.status, 1) << arguments.front() << ' ' << arguments[1];
    expect_json(finished.output, arguments.front());
  }
}

TEST_F(RunningRobot, RunRefusesWhatCannotRun) {
  EXPECT_EQ(segue({"run", "nowhere.yaml"}).status, 1);
  ASSERT_EQ(segue({"init", "rover"}).status, 0);
  const auto unknown = segue({"run", "rover/robot.yaml", "--controller", "exlpore"});
  EXPECT_EQ(unknown.status, 1);
  EXPECT_TRUE(contains(unknown.errors, "did you mean 'explore'?")) << unknown.errors;
  write("rover/controllers/bad.yaml", "network: bad\ntasks:\n  a: {component: \"demo::Nothing\"}\n");
  const auto bad = segue({"run", "rover/robot.yaml"});
  EXPECT_EQ(bad.status, 1);
  EXPECT_TRUE(contains(bad.errors, "bad.yaml:3")) << bad.errors;
}

/// One task whose stop takes a minute, longer than the tests wait.
class StubbornRobot : public SystemTest {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    write("rover/robot.yaml", "robot: rover\nhosts: {onboard: local}\ncontrollers: [\"*.net\"]\n");
    write("rover/busy.net",
          "network: busy\ntasks:\n  a: {component: \"elsewhere::Camera\", properties: {stand_in: {stop: "
          "60s}}}\n");
    write("rover/idle.net", "network: idle\ntasks: {}\n");
  }
};

TEST_F(StubbornRobot, ASecondSignalEndsAtOnceUnlessItBelongsToTheFirst) {
  start({"--stand-in", "--controller", "busy"});
  ASSERT_TRUE(robot_->wait_for("transition_done"));
  const auto first = std::chrono::steady_clock::now();
  robot_->signal(SIGINT);
  ASSERT_TRUE(robot_->wait_for("stopping cleanly"));
  EXPECT_TRUE(eventually([&] {
    robot_->signal(SIGINT);
    return robot_->has_ended();
  }));
  EXPECT_GE(std::chrono::steady_clock::now() - first, std::chrono::milliseconds(200));
  EXPECT_EQ(robot_->wait().status, 130);
}

TEST_F(StubbornRobot, ASwitchThatExceedsItsDeadlineIsStillInProgress) {
  start({"--stand-in", "--controller", "busy"});
  ASSERT_TRUE(robot_->wait_for("transition_done"));
  const auto late = segue({"switch", "idle", "--timeout", "50ms"});
  EXPECT_EQ(late.status, 1);
  EXPECT_TRUE(contains(late.errors, "in progress")) << late.errors;
  EXPECT_EQ(json({"status"}).find("state")->as_string(), "executing");
  EXPECT_EQ(json({"switch", "busy", "--no-wait"}).find("outcome")->as_string(), "requested");
}

TEST_F(StubbornRobot, AClientKilledInACallLeavesTheRobotWhole) {
  start({"--stand-in", "--controller", "busy"});
  ASSERT_TRUE(robot_->wait_for("transition_done"));
  Process doomed(command({"switch", "idle"}), folder_);
  ASSERT_TRUE(robot_->wait_for("from 'busy' to 'idle'"));
  doomed.signal(SIGKILL);
  EXPECT_EQ(doomed.wait().status, 128 + SIGKILL);
  EXPECT_EQ(json({"status"}).find("state")->as_string(), "executing");
}

TEST_F(RunningRobot, CompletionKnowsItsNames) {
  start({"--controller", "manual"});
  ASSERT_EQ(segue({"switch", "manual"}).status, 0);
  EXPECT_EQ(segue({"complete-names", "controllers"}).output, "explore\ngo_to\nhold\nmanual\n");
  EXPECT_TRUE(contains(segue({"complete-names", "ports"}).output, "odometry.pose\n"));
  EXPECT_TRUE(contains(segue({"complete-names", "operations"}).output, "joystick.push\n"));
}

}  // namespace
}  // namespace segue::testing
