// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/test_support.hpp>

#include <gmock/gmock.h>

namespace segue::convert {
namespace {

using ::testing::ElementsAre;
using testing::VirtualRun;

/// A barrier with these states; its decider is added.
std::string beside(const std::string& states) {
  return R"x(
mission: m
actions:
  make: {effects: ["+f"], run: {simulated: {duration: 5s}}}
  fail: {effects: ["+f"], run: {simulated: {duration: 1s, outcomes: [aborted]}}}
  undo: {effects: ["-f"], run: {simulated: {duration: 2s}}}
  make_other: {effects: ["+g"], run: {simulated: {duration: 2s}}}
  rely: {preconditions: [f], run: {simulated: {duration: 1s}}}
  rely_not: {preconditions: ["!f"], run: {simulated: {duration: 7s}}}
  decide: {run: {decide: [{outcome: success}]}}
start: before
states:
  before: {action: rely_not, on: {success: both}}
  both:
    on: {success: after}
    kind: barrier
    states:
)x" + states +
         R"x(
      decider: {kind: decider, action: decide, on: {success: return success}}
  after: {action: rely, on: {success: return success}}
)x";
}

TEST(ParallelFacts, EffectsThatAgreeAreHadSideBySide) {
  const VirtualRun run(beside("      x: {action: make}\n      y: {action: make}\n      z: {action: make}"));
  EXPECT_THAT(run.executions(), ElementsAre("before: success, 0 to 7", "both/x: success, 7 to 12",
                                            "both/y: success, 7 to 12", "both/z: success, 7 to 12",
                                            "both/decider: success, 12 to 12", "after: success, 12 to 13"));
}

TEST(ParallelFacts, EffectsThatContradictKeepTheirOrder) {
  const VirtualRun run(beside("      x: {action: make}\n      y: {action: undo}"));
  EXPECT_THAT(run.executions(),
              ElementsAre("before: success, 0 to 7", "both/x: success, 7 to 12", "both/y: success, 12 to 14",
                          "both/decider: success, 14 to 14", "after: aborted, 14 to 14"));
}

TEST(ParallelFacts, WhoReliesOnAFactWaitsForTheStateBesideThatMakesItTrue) {
  const VirtualRun run(beside("      x: {action: make}\n      y: {action: make}\n      z: {action: rely}"));
  EXPECT_THAT(run.executions(), ElementsAre("before: success, 0 to 7", "both/x: success, 7 to 12",
                                            "both/y: success, 7 to 12", "both/z: success, 12 to 13",
                                            "both/decider: success, 13 to 13", "after: success, 12 to 13"));
}

TEST(ParallelFacts, WhereAStateTakesAwayWhatOneBesideItNeedsTheyRunAsTheyAreWritten) {
  const VirtualRun run(
      beside("      x: {action: make}\n      y: {action: rely_not}\n      z: {action: make_other}"));
  EXPECT_THAT(run.executions(),
              ElementsAre("before: success, 0 to 7", "both: success, 7 to 14", "after: success, 14 to 15"));
}

TEST(ParallelFacts, WhatComesAfterABarrierWaitsForAllThatMayHaveMadeTheFactTrue) {
  const VirtualRun run(beside("      x: {action: fail}\n      y: {action: make}"));
  EXPECT_THAT(run.executions(),
              ElementsAre("before: success, 0 to 7", "both/x: aborted, 7 to 8", "both/y: success, 7 to 12",
                          "both/decider: success, 12 to 12", "after: success, 12 to 13"));
}

TEST(ParallelFacts, EffectsOneAfterAnotherInAStateWaitOnlyForTheirOwnState) {
  const VirtualRun run(beside(R"x(
      x: {action: make}
      y:
        start: one
        states:
          one: {action: fail, on: {success: two, aborted: two}}
          two: {action: make, on: {success: three}}
          three: {action: make_other, on: {success: return success}})x"));
  EXPECT_THAT(run.executions(), ElementsAre("before: success, 0 to 7", "both/x: success, 7 to 12",
                                            "both/y/one: aborted, 7 to 8", "both/y/two: success, 8 to 13",
                                            "both/y/three: success, 13 to 15",
                                            "both/decider: success, 15 to 15", "after: success, 13 to 14"));
}

TEST(ParallelFacts, StatesOfAPreemptiveContainerWhoseEffectsAgreeRaceAsTheyAreWritten) {
  const VirtualRun run(R"x(
mission: m
actions:
  long: {effects: ["+f"], run: {simulated: {duration: 5s}}}
  short: {effects: ["+f"], run: {simulated: {duration: 2s}}}
kind: preemptive
states:
  x: {action: long, on: {success: return success}}
  y: {action: short, on: {success: return success}}
)x");
  EXPECT_THAT(run.executions(), ElementsAre("x: preempted, 0 to 2", "y: success, 0 to 2"));
}

}  // namespace
}  // namespace segue::convert
