// SPDX-License-Identifier: Apache-2.0
// The times that a run is compared with: the chain that it could not have been faster than, and the
// resources.
#include <segue/draw/gantt.hpp>
#include <segue/mission_run/loaded_mission_test_support.hpp>

#include <gmock/gmock.h>

#include <chrono>
#include <string>
#include <vector>

namespace segue::mission_run {
namespace {

using ::testing::ElementsAre;

/// A watch beside the work, which ends first; then something that has nothing to do with either.
constexpr const char* kWatched = R"j(mission: watched
actions:
  fetch: {effects: ["+have(cup)"], run: {simulated: {duration: 5s}}}
  watch: {resources: [{block: gauge}], run: {simulated: {duration: 60s}}}
  charge: {effects: ["+charged"], run: {simulated: {duration: 10s}}}
start: guarded
states:
  guarded:
    kind: preemptive
    on: {success: charge}
    states:
      fetch: {on: {success: return success}}
      watch: {on: {success: return success}}
  charge: {on: {success: return success}}
)j";

/// Three that only share an arm, of which there is one.
constexpr const char* kOneArm = R"j(mission: one_arm
actions:
  a: {effects: ["+a"], resources: [{block: arm}], run: {simulated: {duration: 5s}}}
  b: {effects: ["+b"], resources: [{block: arm}], run: {simulated: {duration: 5s}}}
  c: {effects: ["+c"], resources: [{block: arm}], run: {simulated: {duration: 5s}}}
start: a
states:
  a: {on: {success: b}}
  b: {on: {success: c}}
  c: {on: {success: return success}}
)j";

class ComparedTimes : public LoadedMissions {
 protected:
  std::unique_ptr<FinishedRun> ran(const char* text, RunMode mode) const {
    return load("compared.yaml", text).run(request(std::move(mode))).value();
  }
  static std::vector<std::string> critical(FinishedRun& run) {
    std::vector<std::string> names;
    for (const auto& node : run.gantt().nodes)
      if (node.critical) names.push_back(node.name);
    return names;
  }
  static double in_seconds(Duration time) { return std::chrono::duration<double>(time).count(); }
};

TEST_F(ComparedTimes, WhatComesAfterAContainerIsOnTheCriticalPathBehindTheStateThatEndedIt) {
  for (const RunMode& mode : kBothModes)
    EXPECT_EQ(in_seconds(ran(kWatched, mode)->comparison().critical_path), 15) << is_concurrent(mode);
}

TEST_F(ComparedTimes, AWatchThatIsPreemptedIsNotCriticalInARunAsWritten) {
  EXPECT_THAT(critical(*ran(kWatched, Sequential{})), ElementsAre("guarded/fetch", "charge"));
}

TEST_F(ComparedTimes, ARunIsNoShorterThanItsBusiestResourceIsInUse) {
  const auto run = ran(kOneArm, Concurrent{});
  EXPECT_EQ(in_seconds(run->comparison().critical_path), 5);
  EXPECT_EQ(in_seconds(run->comparison().shortest), 15);
}

}  // namespace
}  // namespace segue::mission_run
