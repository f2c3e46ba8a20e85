// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/run.hpp>
#include <segue/mission/files.hpp>

#include <gtest/gtest.h>

namespace segue::convert {
namespace {

/// Runs in virtual time; all actions are simulated.
std::unique_ptr<Run> ran(std::string_view text) {
  Diagnostics diagnostics;
  auto mission = mission::read_mission(text, "mission.yaml", diagnostics);
  EXPECT_TRUE(mission) << to_string(diagnostics);
  RunOptions options;
  options.clock = cdtn::ClockKind::Virtual;
  auto run =
      Run::create(mission::Program::compile(std::move(*mission)).value(), mission::Runners{}, {}, options)
          .value();
  run->run();
  return run;
}

/// Seconds after the begin.
double start_of(const Run& run, std::string_view path) {
  const auto& network = run.plan().network();
  for (cdtn::NodeId node{0}; cdtn::index(node) < network.size(); node = cdtn::NodeId{cdtn::index(node) + 1}) {
    if (run.plan()[node].path != path) continue;
    const auto& result = run.network_result().nodes[cdtn::index(node)];
    return std::chrono::duration<double>(result.started.time_since_epoch()).count();
  }
  return -1;
}

/// Driving takes eight seconds; what comes after relies on having arrived.
std::string after_driving(const std::string& look) {
  return R"x(
mission: m
actions:
  drive: {effects: ["+at(shelf)"], run: {simulated: {duration: 8s}}}
  look: {)x" +
         look + R"x(, run: {simulated: {duration: 2s}}}
start: drive
states:
  drive: {on: {success: look}}
  look: {on: {success: return success}}
)x";
}

TEST(ConcurrentMission, WhatReadsRealityNeverRunsOnWhatIsOnlyPredicted) {
  const std::string arrived = R"x(preconditions: ["at(shelf)"])x";
  EXPECT_EQ(start_of(*ran(after_driving("pure: true, " + arrived)), "look"), 0);
  EXPECT_EQ(start_of(*ran(after_driving("sensing: true, " + arrived)), "look"), 8);
  EXPECT_EQ(start_of(*ran(after_driving("sensing: true, pure: true, " + arrived)), "look"), 8);
  EXPECT_EQ(start_of(*ran(after_driving("sensing: true, pure: true")), "look"), 8)
      << "it may rely on anything";
}

}  // namespace
}  // namespace segue::convert
