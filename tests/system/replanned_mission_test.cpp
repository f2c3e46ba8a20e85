// SPDX-License-Identifier: Apache-2.0
// Goals that a robot pursues with several plans. SEGUE_REPLANNED_MISSIONS=20 moves the box in as many runs.
#include <support/number_from.hpp>

#include <gmock/gmock.h>

#include <random>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using ::testing::HasSubstr;

constexpr const char* kFetchDomain = R"((define (domain fetch) (:requirements :typing)
  (:types place)
  (:predicates (at ?p - place) (box_at ?p - place) (looking) (aimed ?p - place) (held))
  (:action look :parameters () :precondition (not (looking)) :effect (looking))
  (:action go :parameters (?from ?to - place)
    :precondition (and (looking) (at ?from)) :effect (and (at ?to) (not (at ?from))))
  (:action aim :parameters (?p - place) :precondition (at ?p) :effect (aimed ?p))
  (:action take :parameters (?p - place)
    :precondition (and (at ?p) (aimed ?p) (box_at ?p)) :effect (and (held) (not (box_at ?p)))))
)";
constexpr const char* kFetchProblem = R"((define (problem box) (:domain fetch)
  (:objects home a b c - place) (:init (at home) (box_at a)) (:goal (held))))";
/// The stick of a joystick is the box: its place, and whether one may take it.
constexpr const char* kFetchMapping = R"(plan_mapping: fetch
domain: fetch.pddl
objects:
  place: {home: {x: 0.0, y: 0.0}, a: {x: 0.5, y: 0.0}, b: {x: 1.0, y: 0.0}, c: {x: 1.5, y: 0.0}}
observe:
  box_at(a): {port: box.command, where: "forward == 0.25", settle: 30s}
  box_at(b): {port: box.command, where: "forward == 0.5", settle: 30s}
  box_at(c): {port: box.command, where: "forward == 0.75", settle: 30s}
actions:
  look: {run: {controller: camera}}
  go:
    run:
      controller: go_to
      set: {seeker.speed: 0.3, seeker.tolerance: 0.3}
      call: {seeker.set_goal: {goal: "{to}"}}
      until: [{task: seeker, state: arrived}, {after: 5min}]
  aim: {run: {controller: camera, until: [{port: box.command, where: "turn == 1"}, {after: 5min}]}}
  take: {run: {controller: camera, call: {box.push: {forward: 0.0, turn: 0.0}}}}
)";
constexpr const char* kCamera = R"(network: camera
tasks: {box: {component: "demo::Joystick", properties: {speed: 1.0, turn: 1.0}}}
)";

class ReplannedMission : public SystemTest {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    ASSERT_EQ(segue({"init", "rover"}).status, 0);
    write("fetch.pddl", kFetchDomain);
    write("problem.pddl", kFetchProblem);
    write("mapping.yaml", kFetchMapping);
    write("rover/controllers/camera.yaml", kCamera);
    start();
    ASSERT_EQ(segue({"switch", "camera"}).status, 0);
  }

  /// `place`: 1 is a, 2 is b, 3 is c.
  void push_box(int place, bool may_be_taken) {
    const auto pushed = segue({"call", "box.push", "forward=" + std::to_string(0.25 * place),
                               std::string("turn=") + (may_be_taken ? "1" : "0"), "--beside-mission"});
    EXPECT_EQ(pushed.status, 0) << pushed.errors;
  }

  static std::vector<std::string> pursuit(std::vector<std::string> more = {}) {
    std::vector<std::string> line = {"mission", "plan",     "mapping.yaml", "problem.pddl",
                                     "--run",   "--format", "json"};
    line.insert(line.end(), more.begin(), more.end());
    return command(std::move(line));
  }
  void wait_until_runs(const std::string& state) {
    const auto runs = [&] {
      const auto status = segue({"mission", "status"});
      return status.output.find(state) != std::string::npos;
    };
    ASSERT_TRUE(eventually(runs)) << state << ": " << segue({"mission", "status"}).output;
  }
  static type::Value document(const Finished& finished) {
    const auto value = type::parse_json(finished.output);
    EXPECT_TRUE(value) << finished.output << finished.errors;
    return value.value_or(type::Value::map({}));
  }
  /// What both plans use has not been interrupted where there are none. Waits for the journal, which is
  /// written in the background.
  int transitions_of_the_next_plan() {
    int transitions = 0;
    const bool has_ended = eventually([&] {
      std::string ended;
      const auto history = json({"history", "--missions"});
      for (const auto& entry : history.as_list()) {
        const auto* action = entry.find("action");
        const std::string kind = entry.find("kind")->as_string();
        const bool is_of_mission = action == nullptr || action->as_string().empty();
        if (kind == "ended" && is_of_mission) {
          ended = entry.find("outcome")->as_string();
          if (ended == "aborted") transitions = 0;
        }
        if (kind == "began" && is_of_mission) ended.clear();
        if (kind == "transition") ++transitions;
      }
      return ended == "done";
    });
    EXPECT_TRUE(has_ended) << segue({"history", "--missions"}).output;
    return transitions;
  }
  static std::string error_of(const type::Value& ran) {
    const auto* error = ran.find("error");
    return error == nullptr ? "" : error->as_string();
  }
  static std::string steps(const type::Value& run) {
    std::string text;
    for (const auto& step : run.find("plan")->as_list())
      text += (text.empty() ? "" : ", ") + step.as_string();
    return text;
  }
};

TEST_F(ReplannedMission, FollowsABoxThatIsMoved) {
  std::mt19937 random(29);
  for (int round = 0; round < number_from("SEGUE_REPLANNED_MISSIONS", 2); ++round) {
    const int from = 1 + static_cast<int>(random() % 3);
    const int to = 1 + (from + static_cast<int>(random() % 2)) % 3;
    const std::string place(1, static_cast<char>('a' + from - 1));
    const std::string other(1, static_cast<char>('a' + to - 1));
    SCOPED_TRACE("round " + std::to_string(round) + ", moved from " + place + " to " + other);
    push_box(from, false);
    Process mission(pursuit(), folder_);
    wait_until_runs((round % 2 == 0 ? "aim_" : "_") + place);  // or already on its way there
    push_box(to, true);
    const auto finished = mission.wait();
    ASSERT_EQ(finished.status, 0) << finished.output << finished.errors;
    const auto ran = document(finished);
    EXPECT_TRUE(ran.find("goal_holds")->as_bool());
    const auto& runs = ran.find("runs")->as_list();
    ASSERT_EQ(runs.size(), 2U) << finished.output << finished.errors;
    EXPECT_EQ(steps(runs[0]), "look, go home " + place + ", aim " + place + ", take " + place);
    EXPECT_EQ(runs[0].find("outcome")->as_string(), "aborted");
    EXPECT_THAT(error_of(runs[0]), HasSubstr("box_at(" + place + ")"));
    EXPECT_EQ(steps(runs[1]), "go " + place + " " + other + ", aim " + other + ", take " + other);
    EXPECT_EQ(runs[1].find("outcome")->as_string(), "done");
    EXPECT_EQ(transitions_of_the_next_plan(), 0) << segue({"history", "--missions"}).output;
    EXPECT_EQ(controller(), "camera+go_to");
  }
}

TEST_F(ReplannedMission, NeedsNoPlanForAGoalThatHolds) {
  push_box(1, false);
  write("problem.pddl", R"((define (problem there) (:domain fetch) (:objects home a b c - place)
    (:init (at home) (box_at c)) (:goal (and (box_at a) (not (box_at c))))))");
  const auto ran = document(run(pursuit(), folder_));
  EXPECT_TRUE(ran.find("goal_holds")->as_bool());
  EXPECT_TRUE(ran.find("runs")->as_list().empty());
}

TEST_F(ReplannedMission, LooksAtTheGoalAfterAMissionThatIsDone) {
  push_box(1, false);
  write("problem.pddl", R"((define (problem watch) (:domain fetch) (:objects home a b c - place)
    (:init (at home) (box_at a)) (:goal (and (aimed a) (box_at a)))))");
  Process mission(pursuit(), folder_);
  wait_until_runs("aim_a");
  push_box(2, true);
  const auto finished = mission.wait();
  EXPECT_EQ(finished.status, 1);
  const auto ran = document(finished);
  ASSERT_EQ(ran.find("runs")->as_list().size(), 1U);
  EXPECT_EQ(ran.find("runs")->as_list()[0].find("outcome")->as_string(), "done");
  EXPECT_FALSE(ran.find("goal_holds")->as_bool());
  EXPECT_THAT(error_of(ran), HasSubstr("the problem has no plan"));
}

TEST_F(ReplannedMission, GivesUpAfterAsManyPlansAsItMayMake) {
  push_box(1, false);
  Process mission(pursuit({"--attempts", "1"}), folder_);
  wait_until_runs("aim_a");
  push_box(2, true);
  const auto finished = mission.wait();
  EXPECT_EQ(finished.status, 1);
  EXPECT_EQ(error_of(document(finished)), "the goal does not hold after 1 plan");
  EXPECT_THAT(finished.errors, HasSubstr("the goal does not hold after 1 plan"));
  EXPECT_EQ(controller(), "hold") << "the robot comes to rest";
}

/// Its planner is a script that finds the first plan, and does what it is told about the next one.
class NextPlan : public ReplannedMission {
 protected:
  /// Begins, and has the box moved.
  std::unique_ptr<Process> begin(const std::string& next, const std::string& timeout = "5min") {
    write("planner.sh",
          "#!/bin/sh\ncd $(dirname $0)\nif [ ! -e begun ]; then\n  touch begun\n"
          "  echo '(look) (go home a) (aim a) (take a)'\n  exit\nfi\ntouch again\n" +
              next + "\n");
    std::filesystem::permissions(folder_ / "planner.sh", std::filesystem::perms::owner_all);
    for (const char* file : {"begun", "again"})
      std::filesystem::remove(folder_ / file);
    write("planner.yaml", "robot: r\nplanner: {command: [./planner.sh], timeout: " + timeout + "}\n");
    push_box(1, false);
    auto mission = std::make_unique<Process>(pursuit({"--robot-file", "planner.yaml"}), folder_);
    wait_until_runs("aim_a");
    push_box(2, true);
    return mission;
  }
  void wait_until_it_plans_again() {
    ASSERT_TRUE(eventually([&] { return std::filesystem::exists(folder_ / "again"); }));
  }
  void expect_failure(const Finished& finished, const std::string& error) {
    EXPECT_EQ(finished.status, 1);
    const auto ran = document(finished);
    EXPECT_FALSE(ran.find("goal_holds")->as_bool());
    EXPECT_EQ(ran.find("runs")->as_list().size(), 1U) << "nothing ran afterwards";
    EXPECT_THAT(finished.errors, HasSubstr(error));
  }
};

TEST_F(NextPlan, IsReportedTrulyWhereThereIsNone) {
  const std::pair<const char*, const char*> failures[] = {
      {"sleep 1000", "the planner found no plan within 1s"},
      {"kill -KILL $$", "signal 9 (Killed) ended the planner"},
      {"echo Welcome to the planner", ":1:1: error: this is not a step of a plan"},
      {"echo no solution >&2; exit 12", "the planner ended with status 12"},
      {"echo '(take b)'", ":1:1: error: at(b) does not hold before this step"}};
  for (const auto& [next, error] : failures) {
    SCOPED_TRACE(next);
    ASSERT_EQ(segue({"switch", "camera"}).status, 0);
    const auto finished = begin(next, "1s")->wait();
    expect_failure(finished, error);
    EXPECT_THAT(finished.errors, HasSubstr("the robot is at rest"));
    EXPECT_EQ(controller(), "hold");
  }
}

TEST_F(NextPlan, IsNotMadeAnyMoreAfterAStop) {
  for (const bool by_signal : {true, false}) {
    ASSERT_EQ(segue({"switch", "camera"}).status, 0);
    auto mission = begin("sleep 1000");
    wait_until_it_plans_again();
    if (by_signal) {
      mission->signal(SIGINT);
    } else {
      EXPECT_EQ(segue({"mission", "stop"}).status, 0);
    }
    expect_failure(mission->wait(), "it was stopped");
    EXPECT_EQ(controller(), "hold");
  }
}

TEST_F(NextPlan, IsNotMadeWhereTheRunWasStopped) {
  push_box(1, false);
  Process mission(pursuit(), folder_);
  wait_until_runs("aim_a");
  mission.signal(SIGINT);
  const auto finished = mission.wait();
  expect_failure(finished, "it was stopped");
  EXPECT_EQ(document(finished).find("runs")->as_list()[0].find("outcome")->as_string(), "preempted");
  EXPECT_EQ(controller(), "hold");
}

TEST_F(NextPlan, DoesNotRunOnARobotThatWasTakenOver) {
  auto mission = begin("while [ ! -e go ]; do sleep 0.01; done; echo '(go a b) (aim b) (take b)'");
  wait_until_it_plans_again();
  ASSERT_EQ(segue({"switch", "explore", "--take-over"}).status, 0);
  write("go", "");
  expect_failure(mission->wait(), "the robot was taken over by segue switch");
  EXPECT_EQ(controller(), "explore");
}

TEST_F(NextPlan, DoesNotRunOnARobotThatIsGone) {
  auto mission = begin("while [ ! -e go ]; do sleep 0.01; done; echo '(go a b) (aim b) (take b)'");
  wait_until_it_plans_again();
  robot_->signal(SIGKILL);
  robot_->wait();
  write("go", "");
  expect_failure(mission->wait(), "it is not known whether the robot is at rest");
}

}  // namespace
}  // namespace segue::testing
