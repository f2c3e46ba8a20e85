// SPDX-License-Identifier: Apache-2.0
// How far concurrent runs plan loops ahead, and beyond loops in the states of a barrier.
#include <segue/convert/test_support.hpp>

#include <gmock/gmock.h>

namespace segue::convert {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using testing::program;
using testing::VirtualRun;

/// Two searches beside each other, each repeated until it finds something; then a plan that needs neither.
/// The rounds of the searches, from the first one: how they end.
std::string searches(const std::string& left, const std::string& right) {
  return R"x(
mission: m
actions:
  left: {sensing: true, effects: ["+seen(left)"], outcomes: [found, nothing], expect: {outcome: found, duration: 2s}, run: {simulated: {duration: 2s, outcomes: [)x" +
         left + R"x(]}}}
  right: {sensing: true, effects: ["+seen(right)"], outcomes: [found, nothing], expect: {outcome: found, duration: 3s}, run: {simulated: {duration: 3s, outcomes: [)x" +
         right + R"x(]}}}
  plan: {pure: true, outputs: {way: int}, run: {simulated: {duration: 4s, outputs: {way: 7}}}}
  go: {inputs: {way: int}, effects: ["+gone()"], run: {simulated: {duration: 1s}}}
  both: {run: {decide: [{outcome: success}]}}
start: search
states:
  search:
    kind: barrier
    on: {success: plan}
    states:
      to_left:
        start: left
        states:
          left: {on: {found: return success, nothing: left}}
      to_right:
        start: right
        states:
          right: {on: {found: return success, nothing: right}}
      both: {kind: decider, on: {success: return success}}
  plan: {on: {success: go}}
  go: {on: {success: return success}}
flows: [plan.way -> go.way]
)x";
}

TEST(LoopsInABarrier, DoNotKeepWhatFollowsFromRunningAhead) {
  const VirtualRun run(searches("found", "found"));
  EXPECT_THAT(run.executions(),
              ElementsAre("search/to_left/left: found, 0 to 2", "search/to_right/right: found, 0 to 3",
                          "search/both: success, 3 to 3", "plan: success, 0 to 4", "go: success, 4 to 5"));
}

/// The plan behind a loop is discarded when the loop goes on, and is made again at once.
TEST(LoopsInABarrier, GoOnAsSoonAsTheyMust) {
  EXPECT_THAT(VirtualRun(searches("nothing, nothing, found", "found")).executions(),
              ElementsAre("search/to_left/left: nothing, 0 to 2", "search/to_right/right: found, 0 to 3",
                          "search/to_left/left: nothing, 2 to 4", "search/to_left/left: found, 4 to 6",
                          "search/both: success, 6 to 6", "plan: success, 4 to 8", "go: success, 8 to 9"));
  EXPECT_THAT(VirtualRun(searches("nothing, found", "nothing, found")).executions(),
              ElementsAre("search/to_left/left: nothing, 0 to 2", "search/to_right/right: nothing, 0 to 3",
                          "search/to_left/left: found, 2 to 4", "search/to_right/right: found, 3 to 6",
                          "search/both: success, 6 to 6", "plan: success, 3 to 7", "go: success, 7 to 8"));
}

TEST(LoopsInABarrier, AreNamedWhereThePlanWaitsForThem) {
  const auto made = MissionPlan::create(program(searches("found", "found"))).value();
  ASSERT_TRUE(plan_ahead(*made, 100));
  EXPECT_EQ(made->waits_for(), "whether the loop at search/to_right/right goes on, which is not expected");
}

/// A loop whose rounds take no time behind an action that takes a second. In the sequential run, `slow`
/// aborts first, and nobody gets to the loop.
std::string endless_loop(const std::string& round) {
  return R"x(
mission: m
actions:
  slow: {effects: ["+x"], run: {simulated: {duration: 1s, outcomes: [aborted]}}}
  never: {preconditions: [g], effects: ["+y"], run: {simulated: {duration: 1s}}}
  say: {effects: ["+z"], run: {simulated: {duration: 0s}}}
start: slow
states:
  slow: {on: {success: again}}
  again: {action: never, on: {success: return success, aborted: )x" +
         round + "}}\n  say: {on: {success: again}}\n";
}

TEST(LoopsAhead, OfActionsThatDoNotBeginDoNotGoOnForEver) {
  const VirtualRun run(endless_loop("again"));
  EXPECT_EQ(run.result.outcome, mission::kAborted);
  EXPECT_EQ(run.result.error, "simulated failure");
  EXPECT_EQ(run.network_result().statistics.starts, 1U);
}

TEST(LoopsAhead, OfActionsThatTakeNoTimeDoNotGoOnForEver) {
  const VirtualRun run(endless_loop("say"));
  EXPECT_EQ(run.result.outcome, mission::kAborted);
  EXPECT_EQ(run.result.error, "simulated failure");
}

/// Rounds of the loop `search` that find nothing, before one that does.
std::string repeated_search(int rounds, const std::string& duration) {
  std::string outcomes;
  for (int i = 0; i < rounds; ++i)
    outcomes += "nothing, ";
  return "  search: {sensing: true, effects: [\"+seen()\"], outcomes: [found, nothing], run: {simulated: "
         "{duration: " +
         duration + ", outcomes: [" + outcomes + "found]}}}\n";
}

TEST(LoopsAhead, GoOnOnceWhatIsBeforeThemHasEnded) {
  const VirtualRun run("mission: m\nactions:\n" + repeated_search(2999, "0s") +
                       R"x(  slow: {effects: ["+x"], run: {simulated: {duration: 2s}}}
start: slow
states:
  slow: {on: {success: search}}
  search: {on: {found: return success, nothing: search}}
)x");
  EXPECT_EQ(run.result.outcome, 0) << run.result.error;
  EXPECT_EQ(run.executions().size(), 3001U);
  EXPECT_EQ(run.executions().back(), "search: found, 2 to 2");
}

TEST(LoopsAhead, WaitForNothingThatIsBesideThem) {
  const VirtualRun run("mission: m\nactions:\n" + repeated_search(2999, "1ms") +
                       R"x(  slow: {effects: ["+x"], run: {simulated: {duration: 10s}}}
  both: {run: {decide: [{outcome: success}]}}
kind: barrier
states:
  slow: {action: slow}
  searches:
    start: search
    states:
      search: {on: {found: return success, nothing: search}}
  both: {kind: decider, on: {success: return success}}
)x");
  EXPECT_EQ(run.result.outcome, 0) << run.result.error;
  EXPECT_THAT(run.executions(), Contains("searches/search: found, 2 to 3"));
}

}  // namespace
}  // namespace segue::convert
