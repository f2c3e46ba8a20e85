// SPDX-License-Identifier: Apache-2.0
// `segue bench mission` on a robot of the demo.
#include <gmock/gmock.h>

#include <fstream>
#include <iterator>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using ::testing::HasSubstr;

/// The second trip can be planned during the first one. What is expected of a drive is far from the truth.
constexpr const char* kTour = R"(mission: tour
inputs: {far: {type: float, default: 1.0}}
actions:
  plan:
    inputs: {x: float}
    outcomes: [found, no_route]
    pure: true
    run:
      pool: planner
      call: {plan: {from: {x: 0.0, y: 0.0}, to: {x: "{x}", y: 0.0}}}
      outcome_from: outcome
  drive: {expect: {duration: 1h}, run: {controller: go_to, until: [{after: 50ms, outcome: success}]}}
libraries:
  trip:
    inputs: {far: float}
    flows: [inputs.far -> plan.x]
    start: plan
    states:
      plan: {on: {found: drive, no_route: return aborted}}
      drive: {on: {success: return success}}
outcomes: [done]
flows: [inputs.far -> out.far, inputs.far -> back.far]
start: out
states:
  out: {library: trip, on: {success: back}}
  back: {library: trip, on: {success: return done}}
)";

constexpr const char* kFailing = R"(mission: failing
actions:
  drive: {run: {controller: go_to, until: [{after: 1ms, outcome: aborted}]}}
start: drive
states: {drive: {on: {success: return success}}}
)";

class BenchMission : public SystemTest {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    ASSERT_EQ(segue({"init", "rover"}).status, 0);
    std::ofstream(folder_ / "rover/robot.yaml", std::ios::app)
        << "pools: {planner: {component: \"demo::RoutePlanner\", properties: {effort: 50ms}}}\n";
    write("tour.yaml", kTour);
    write("failing.yaml", kFailing);
  }
  static std::vector<std::string> bench(const std::string& mission, std::vector<std::string> more) {
    more.insert(more.begin(), {"bench", "mission", "rover/robot.yaml", mission, "--runs", "1"});
    return more;
  }
};

TEST_F(BenchMission, ItComparesBothModesInEachSetting) {
  const auto report = json(
      bench("tour.yaml", {"--pool", "planner=1,2", "--sweep", "seeker.speed=1.5", "--sweep",
                          "seeker.tolerance=0.1", "--seed", "far", "--published", "11 %", "--out", "out"}));
  const auto& cells = report.find("cells")->as_list();
  ASSERT_EQ(cells.size(), 2U);
  for (const type::Value& cell : cells) {
    ASSERT_EQ(cell.find("runs")->as_list().size(), 2U);
    for (const type::Value& run : cell.find("runs")->as_list()) {
      EXPECT_EQ(run.find("outcome")->as_string(), "done") << type::to_json(run);
      EXPECT_EQ(run.find("seed")->as_int(), 1);
      EXPECT_GT(run.find("ideal_s")->as_double(), 0.15) << "one plan and both drives, one after another";
      EXPECT_LE(run.find("ideal_s")->as_double(), run.find("makespan_s")->as_double());
      EXPECT_GE(run.find("deciding_s")->as_double(), 0);
      EXPECT_LE(run.find("deciding_s")->as_double(), run.find("makespan_s")->as_double());
    }
    EXPECT_EQ(cell.find("wall")->find("saved")->find("pairs")->as_int(), 1);
    EXPECT_GT(cell.find("wall")->find("ideal_saves")->find("mean")->as_double(), 0);
  }
  EXPECT_EQ(cells[1].find("setting")->find("planner")->as_int(), 2);
  EXPECT_EQ(cells[0].find("published")->as_string(), "11 %");
  std::ifstream csv(folder_ / "out/tour.csv");
  const std::string text((std::istreambuf_iterator<char>(csv)), std::istreambuf_iterator<char>());
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 5) << text;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/tour.svg"));
  EXPECT_TRUE(eventually([&] { return processes_of(folder_ / "runtime").empty(); })) << "a process is left";
}

TEST_F(BenchMission, ASequentialRunWithOneInstanceIsMadeOnceForAllSizes) {
  const auto report = json(bench("tour.yaml", {"--pool", "planner=1,2", "--sequential-pools", "1"}));
  std::vector<double> sequential;
  for (const type::Value& cell : report.find("cells")->as_list()) {
    for (const type::Value& run : cell.find("runs")->as_list()) {
      EXPECT_GT(run.find("planning_s")->as_double(), 0.04) << "a plan takes 50 ms";
      EXPECT_LT(run.find("planning_s")->as_double(), run.find("makespan_s")->as_double());
      if (run.find("mode")->as_string() == "sequential")
        sequential.push_back(run.find("makespan_s")->as_double());
    }
  }
  ASSERT_EQ(sequential.size(), 2U);
  EXPECT_EQ(sequential[0], sequential[1]);
}

TEST_F(BenchMission, ATableNeedsTheFilesOfTheRover) {
  EXPECT_THAT(segue({"bench", "mission"}).errors,
              HasSubstr("name the robot file and the mission file, or a table (--table)"));
  EXPECT_THAT(segue({"bench", "mission", "--table", "1"}).errors, HasSubstr("table_robot.yaml"));
  EXPECT_EQ(segue({"bench", "mission", "--table", "3"}).status, 2);
}

TEST_F(BenchMission, RunsThatFailAreCountedWithTheirMessage) {
  const auto finished = segue(bench("failing.yaml", {}));
  EXPECT_EQ(finished.status, 0) << finished.errors;
  EXPECT_THAT(finished.output, HasSubstr("0/1, 0/1"));
  EXPECT_THAT(finished.output, HasSubstr("concurrent, run 1: aborted: "));
}

TEST_F(BenchMission, WhatTheRobotLacksIsNamed) {
  const auto pool = segue(bench("tour.yaml", {"--pool", "planer=1"}));
  EXPECT_EQ(pool.status, 1);
  EXPECT_THAT(pool.errors, HasSubstr("no pool 'planer', did you mean 'planner'?"));
  const auto task = segue(bench("tour.yaml", {"--seed", "nobody.seed"}));
  EXPECT_EQ(task.status, 1);
  EXPECT_THAT(task.errors, HasSubstr("no controller of robot 'rover' has a task 'nobody'"));
  const auto clock = segue(bench("tour.yaml", {"--clock", "seeker.nothing"}));
  EXPECT_EQ(clock.status, 1);
  EXPECT_THAT(clock.errors, HasSubstr("the clock seeker.nothing of the robot gave no time: "));
  EXPECT_THAT(segue(bench("tour.yaml", {"--pool", "planner=0"})).errors,
              HasSubstr("a pool has between 1 and 256 instances, not 0"));
}

}  // namespace
}  // namespace segue::testing
