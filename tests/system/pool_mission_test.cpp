// SPDX-License-Identifier: Apache-2.0
// Missions whose actions are calls of a robot's pool of processes.
#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;

/// Plans a route.
constexpr const char* kPlan = R"(mission: plan
actions:
  plan:
    outputs: {points: list}
    outcomes: [found, no_route]
    pure: true
    run:
      pool: planner
      call: {plan: {from: {x: 0.0, y: 0.0}, to: {x: 1.0, y: 0.0}}}
      outcome_from: outcome
      outputs: {points: points}
      timeout: 10min
outcomes: [found, no_route]
outputs: {points: list}
flows: [plan.points -> outputs.points]
start: plan
states: {plan: {on: {found: return found, no_route: return no_route}}}
)";

class PoolMission : public SystemTest {
 protected:
  /// A robot whose planners take very long.
  void start_with_pool(const std::string& size, const std::string& more = "",
                       const std::string& effort = "1h") {
    ASSERT_EQ(segue({"init", "rover"}).status, 0);
    std::ifstream robot(folder_ / "rover/robot.yaml");
    const std::string file((std::istreambuf_iterator<char>(robot)), std::istreambuf_iterator<char>());
    write("rover/robot.yaml", file + "pools: {planner: {component: \"demo::RoutePlanner\", size: " + size +
                                  ", properties: {effort: " + effort + "}" + more + "}}\n");
    start();
    write("plan.yaml", kPlan);
    wait_until([&] { return pool().find("ready")->as_int() == pool().find("size")->as_int(); });
  }
  type::Value pool() { return json({"status"}).find("pools")->as_list().at(0); }
  std::int64_t busy() {
    const auto instances = pool().find("instances")->as_list();
    return std::ranges::count_if(instances, [](const auto& one) { return one.find("busy")->as_bool(); });
  }
  std::vector<int> pids_of_planners() {
    std::vector<int> pids;
    for (const auto& [pid, program] : processes_of(folder_ / "runtime")) {
      std::ifstream file("/proc/" + std::to_string(pid) + "/cmdline");
      const std::string line((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
      if (line.find("planner_") != std::string::npos) pids.push_back(pid);
    }
    return pids;
  }
  std::size_t processes_of_planners() { return pids_of_planners().size(); }
  type::Value first() { return pool().find("instances")->as_list().at(0); }
  int pid_of_first() { return static_cast<int>(first().find("pid")->as_int()); }
  void kill_first() { ::kill(pid_of_first(), SIGKILL); }
  /// Another process than that one has it, and it can be used.
  void wait_until_first_is_anew(int before) {
    wait_until([&] {
      const auto instance = first();
      return instance.find("ready")->as_bool() && instance.find("pid")->as_int() != before;
    });
    EXPECT_FALSE(first().find("busy")->as_bool());
  }
  void wait_until_planning() {
    wait_until([&] {
      return segue({"mission", "status"}).output.find("under way: plan") != std::string::npos;
    });
  }
  template <class Condition>
  void wait_until(const Condition& condition) {
    ASSERT_TRUE(eventually(condition)) << segue({"status"}).output;
  }
};

TEST_F(PoolMission, GoesOnWithAnotherInstanceWhereOneIsKilled) {
  start_with_pool("2");
  for (const std::string mode : {"sequential", "concurrent"}) {
    SCOPED_TRACE(mode);
    ASSERT_EQ(segue({"set", "planner_2.effort=0ms"}).status, 0);
    Process mission(command({"mission", "run", "plan.yaml", "--mode", mode}), folder_);
    wait_until_planning();
    kill_first();
    const auto finished = mission.wait();
    EXPECT_EQ(finished.status, 0) << finished.errors;
    EXPECT_THAT(finished.output, HasSubstr("plan: found"));
    wait_until([&] { return pool().find("ready")->as_int() == 2; });
  }
  EXPECT_EQ(segue({"switch", "explore"}).status, 0);
  EXPECT_EQ(pool().find("ready")->as_int(), 2);
}

TEST_F(PoolMission, SaysWhyWhereNoInstanceIsLeft) {
  start_with_pool("1", ", on_failure: report");
  Process mission(command({"mission", "run", "plan.yaml"}), folder_);
  wait_until_planning();
  kill_first();
  const auto finished = mission.wait();
  EXPECT_EQ(finished.status, 1) << segue({"status"}).output << segue({"events"}).output;
  // Its connection ends before the system says that it has ended.
  EXPECT_THAT(finished.errors + finished.output,
              ContainsRegex("no instance of pool 'planner' is ready: planner_1: its process (is gone|does "
                            "not answer)"));
  EXPECT_THAT(segue({"status"}).output, HasSubstr("pool planner: 0 of 1 ready"));
  EXPECT_EQ(segue({"switch", "explore"}).status, 0) << "the controllers do not depend on it";
}

/// Or it would plan for an hour.
TEST_F(PoolMission, ACallThatIsNotAnsweredInTimeNamesItsTimeLimitAndEndsTheInstance) {
  start_with_pool("1");
  const int before = pid_of_first();
  const auto late =
      segue({"call", "planner_1.plan", "from={x: 0.0, y: 0.0}", "to={x: 1.0, y: 0.0}", "--timeout", "100ms"});
  EXPECT_EQ(late.status, 1);
  EXPECT_THAT(late.errors, HasSubstr("planner_1.plan has not answered within 100ms, see --timeout"));
  wait_until_first_is_anew(before);
}

TEST_F(PoolMission, AnInstanceThatWorksForAMissionThatWasKilledBeginsAnew) {
  start_with_pool("1");
  const int before = pid_of_first();
  Process mission(command({"mission", "run", "plan.yaml"}), folder_);
  wait_until_planning();
  wait_until([&] { return first().find("busy")->as_bool(); });
  mission.signal(SIGKILL);
  mission.wait();
  wait_until_first_is_anew(before);
}

TEST_F(PoolMission, OneThatLosesItsRuntimeIsResumed) {
  start_with_pool("1");
  for (const std::string mode : {"sequential", "concurrent"}) {
    SCOPED_TRACE(mode);
    std::vector<std::string> line = {"mission", "run",       "plan.yaml",      "--mode",
                                     mode,      "--journal", "journal." + mode};
    Process mission(command(line), folder_);
    wait_until_planning();
    wait_until([&] { return first().find("busy")->as_bool(); });
    const int before = pid_of_first();
    robot_->signal(SIGKILL);
    robot_->wait();
    const auto lost = mission.wait();
    EXPECT_EQ(lost.status, 1);
    EXPECT_THAT(lost.errors, HasSubstr("when it runs again, the mission goes on with --resume"));
    start();
    wait_until_first_is_anew(before);
    ASSERT_EQ(segue({"set", "planner_1.effort=0ms"}).status, 0);
    line.emplace_back("--resume");
    const auto resumed = segue(line);
    EXPECT_EQ(resumed.status, 0) << resumed.errors;
    EXPECT_THAT(resumed.output, HasSubstr("plan: found"));
    ASSERT_EQ(segue({"set", "planner_1.effort=1h"}).status, 0);
  }
}

/// Three plans side by side.
constexpr const char* kThreePlans = R"(mission: plans
actions:
  plan:
    pure: true
    run: {pool: planner, call: {plan: {from: {x: 0.0, y: 0.0}, to: {x: 1.0, y: 0.0}}}, timeout: 10min}
  all: {run: {decide: [{outcome: success}]}}
start: all_three
states:
  all_three:
    kind: barrier
    on: {success: return success}
    states:
      a: {action: plan}
      b: {action: plan}
      c: {action: plan}
      all: {kind: decider, on: {success: return success}}
)";

TEST_F(PoolMission, GrowsThePoolWithItsDemandWhichShrinksAgain) {
  start_with_pool("1..3", ", idle_after: 100ms");
  write("plans.yaml", kThreePlans);
  for (const std::string mode : {"sequential", "concurrent"}) {
    SCOPED_TRACE(mode);
    EXPECT_EQ(pool().find("size")->as_int(), 1);
    Process mission(command({"mission", "run", "plans.yaml", "--mode", mode}), folder_);
    wait_until([&] { return busy() == 3; });
    EXPECT_THAT(segue({"status"}).output, HasSubstr("pool planner: 3 of 3 ready, 1 to 3 on demand"));
    EXPECT_EQ(segue({"switch", "explore", "--take-over"}).status, 0) << "no switch waits for them";
    EXPECT_EQ(busy(), 3);
    mission.signal(SIGKILL);
    mission.wait();
    wait_until([&] { return pool().find("size")->as_int() == 1 && pool().find("ready")->as_int() == 1; });
    wait_until([&] { return processes_of_planners() == 1U; });
    EXPECT_EQ(segue({"switch", "go_to"}).status, 0);
  }
  EXPECT_THAT(segue({"events"}).output, ContainsRegex("planner_3.*is made, since calls wait"));
  EXPECT_THAT(segue({"events"}).output, ContainsRegex("planner_[123].*is ended, since nobody has needed it"));
}

TEST_F(PoolMission, EndsWithWhatInstancesOnDemandAnswer) {
  start_with_pool("0..3", ", idle_after: 100ms", "1ms");
  write("plans.yaml", kThreePlans);
  for (const std::string mode : {"sequential", "concurrent"}) {
    const auto finished = segue({"mission", "run", "plans.yaml", "--mode", mode});
    EXPECT_EQ(finished.status, 0) << finished.errors;
    EXPECT_THAT(finished.output, HasSubstr("plans: success"));
  }
  wait_until([&] { return pool().find("size")->as_int() == 0 && processes_of_planners() == 0U; });
  EXPECT_EQ(segue({"status", "--exit-code"}).status, 0) << "it lacks nothing";
}

TEST_F(PoolMission, GoesOnWhereAnInstanceIsKilledWhileItIsMade) {
  start_with_pool("0..1", "", "1ms");
  write("plans.yaml", kThreePlans);
  std::atomic<bool> ended = false;
  std::size_t killed = 0;
  std::jthread killer([&] {
    // Whenever its process is there for the first time, whatever it is doing then.
    while (!ended && killed == 0) {
      for (const int pid : pids_of_planners())
        killed += ::kill(pid, SIGKILL) == 0 ? 1 : 0;
    }
  });
  const auto finished = segue({"mission", "run", "plans.yaml"});
  ended = true;
  killer.join();
  EXPECT_EQ(killed, 1U);
  EXPECT_EQ(finished.status, 0) << finished.errors << segue({"events"}).output;
}

TEST_F(PoolMission, LeavesNoInstanceWhereItsRuntimeIsKilledWhileThePoolIsLarge) {
  start_with_pool("1..3");
  write("plans.yaml", kThreePlans);
  Process mission(command({"mission", "run", "plans.yaml"}), folder_);
  wait_until([&] { return busy() == 3; });
  robot_->signal(SIGKILL);
  robot_->wait();
  mission.wait();
  EXPECT_EQ(processes_of_planners(), 3U);
  start();
  wait_until([&] { return pool().find("ready")->as_int() == 1 && processes_of_planners() == 1U; });
}

TEST_F(PoolMission, NeedsAPoolOfTheRobot) {
  start();
  write("plan.yaml", kPlan);
  const auto refused = segue({"mission", "run", "plan.yaml"});
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.errors, HasSubstr("the robot has no pool 'planner'"));
}

}  // namespace
}  // namespace segue::testing
