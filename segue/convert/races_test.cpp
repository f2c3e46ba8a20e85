// SPDX-License-Identifier: Apache-2.0
//
// Preemptive containers in concurrent runs.
#include <segue/base/file.hpp>
#include <segue/convert/ahead_of_failures.hpp>
#include <segue/convert/concurrent_run.hpp>
#include <segue/convert/test_support.hpp>
#include <segue/mission/mission_io.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <unistd.h>

namespace segue::convert {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using testing::program;
using testing::VirtualRun;

/// Two steps that do not depend on each other, beside a watch that ends after `watch` seconds.
std::string watched(int watch, const std::string& more = "") {
  return R"x(
mission: m
actions:
  fetch: {effects: ["+fetched()"], run: {simulated: {duration: 5s}}}
  sweep: {effects: ["+swept()"], run: {simulated: {duration: 4s}}}
  watch: {outcomes: [low], effects: ["+low()"], run: {simulated: {duration: )x" +
         std::to_string(watch) + R"x(s}}}
  dock: {preconditions: ["low()"], run: {simulated: {duration: 1s}}}
)x" + more +
         R"x(
start: both
states:
  both:
    kind: preemptive
    outcomes: [done, low]
    on: {done: return success, low: dock}
    states:
      work:
        on: {success: return done}
        start: fetch
        states:
          fetch: {on: {success: sweep}}
          sweep: {on: {success: return success}}
      watch: {on: {low: return low}}
  dock: {on: {success: return success}}
)x";
}

TEST(Races, AWatchDoesNotCostTheParallelism) {
  const VirtualRun run(watched(60));
  EXPECT_EQ(run.result.outcome_name, "success");
  EXPECT_THAT(run.executions(),
              ElementsAre("both/watch: preempted, 0 to 5", "both/work/fetch: success, 0 to 5",
                          "both/work/sweep: success, 0 to 4"));
}

TEST(Races, TheFirstThatEndsPreemptsWhatRunsAndTakesTheRestOffThePath) {
  const VirtualRun run(watched(2));
  EXPECT_THAT(run.executions(), ElementsAre("both/watch: low, 0 to 2", "both/work/fetch: preempted, 0 to 2",
                                            "both/work/sweep: preempted, 0 to 2", "dock: success, 2 to 3"));
  EXPECT_THAT(run.network_result().world.texts(run.plan().network().facts), ElementsAre("low()"));
}

TEST(Races, StatesBeginOnlyWhenWhatComesBeforeHasEnded) {
  std::string text = watched(60);
  const auto replace = [&](const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
  };
  replace("start: both\nstates:", "start: drive\nstates:\n  drive: {on: {success: both}}");
  replace("actions:", "actions:\n  drive: {effects: [\"+there()\"], run: {simulated: {duration: 3s}}}");
  EXPECT_THAT(VirtualRun(text).executions(),
              ElementsAre("drive: success, 0 to 3", "both/watch: preempted, 3 to 8",
                          "both/work/fetch: success, 3 to 8", "both/work/sweep: success, 3 to 7"));
}

TEST(Races, AnAbortThatNobodyHandlesPreemptsTheOthersAndEndsTheMission) {
  std::string text = watched(2);
  const std::string ends = "{simulated: {duration: 2s}}";
  text.replace(text.find(ends), ends.size(),
               "{simulated: {duration: 2s, outcomes: [aborted], error: no sensor}}");
  const VirtualRun run(text);
  EXPECT_EQ(run.result.outcome_name, "aborted");
  EXPECT_EQ(run.result.error, "no sensor");
  EXPECT_THAT(run.executions(),
              ElementsAre("both/watch: aborted, 0 to 2", "both/work/fetch: preempted, 0 to 2",
                          "both/work/sweep: preempted, 0 to 2"));
}

TEST(Races, AStrictWatchRunsBesideWhatMayFail) {
  RunOptions options;
  options.strict = true;
  EXPECT_THAT(
      VirtualRun(watched(2), options).executions(),
      ElementsAre("both/watch: low, 0 to 2", "both/work/fetch: preempted, 0 to 2", "dock: success, 2 to 3"));
}

TEST(Races, WhatIsListedAsAheadOfAFailureIsNotWhatRunsBesideIt) {
  const AheadOfFailures ahead = ahead_of_failures(program(watched(2))).value();
  ASSERT_EQ(ahead.pairs.size(), 1U);
  EXPECT_EQ(ahead.pairs[0].acts, "both/work/sweep");
  EXPECT_THAT(ahead.pairs[0].fails, ElementsAre("both/work/fetch"));
}

TEST(Races, WhatGoesOnThoughPreemptedIsGivenUp) {
  std::string text = watched(2);
  const std::string ends = "{simulated: {duration: 5s}}";
  text.replace(text.find(ends), ends.size(), "{callback: deaf}");
  class Deaf final : public mission::ActionRunner {
   public:
    std::optional<mission::Ending> start(mission::ActionCall& call) override {
      end_ = call.defer([] {});
      return std::nullopt;
    }

   private:
    mission::Completer end_;
  };
  mission::Runners runners;
  runners.add("deaf", std::make_shared<Deaf>());
  std::vector<std::string> ends_of_deaf;
  RunOptions options;
  options.preemption_grace = std::chrono::milliseconds(1);
  options.observe = [&](const mission::StateEvent& event) {
    if (event.kind == mission::StateEvent::Kind::Ended && event.path == "both/work/fetch")
      ends_of_deaf.push_back(std::string(event.outcome) + ": " + std::string(event.error));
  };
  // The watch ends in virtual time, which stands still until the deaf action is given up, so it waits as
  // well.
  text.replace(text.find("duration: 2s"), 12, "duration: 0s");
  const VirtualRun run(text, options, std::move(runners));
  EXPECT_EQ(run.result.outcome_name, "success");
  EXPECT_THAT(ends_of_deaf, ElementsAre("aborted: it was preempted, but went on; given up"));
}

TEST(Races, ConflictingStatesRunAsWritten) {
  const VirtualRun run(watched(60, "  unused: {run: {simulated: {}}}\n"));
  EXPECT_EQ(run.plan().subtree_reason(1).kind, OpaqueSubtreeReason::Kind::None);
  std::string text = watched(60);
  text.replace(text.find("+swept()"), 8, "-low()");
  const VirtualRun conflicting(text);
  EXPECT_THAT(conflicting.executions(), ElementsAre("both: done, 0 to 9"));
  EXPECT_EQ(conflicting.plan().subtree_reason(1).kind, OpaqueSubtreeReason::Kind::ConflictBeside);
}

/// To go on with a run of which the journal has what `record` writes.
RunOptions resumed(const std::string& text, const std::function<void(mission::RunJournal&)>& record) {
  const auto file =
      std::filesystem::path(::testing::TempDir()) / ("segue_races_" + std::to_string(::getpid()));
  std::filesystem::remove(file);
  const auto mission = program(text)->mission();
  mission::RunJournal::Start start;
  start.concurrent = true;
  record(*mission::RunJournal::create(file, mission, start).value());
  RunOptions options;
  options.journal = mission::RunJournal::resume(file, mission, true, mission::UnderWay::Refuse).value();
  std::filesystem::remove(file);
  return options;
}

/// Both states have ended in the journal, since both did so before either could be preempted.
TEST(Races, AResumedRunGoesTheWayThatTheEarlierOneWent) {
  const std::string text = R"x(
mission: m
actions:
  a: {effects: ["+a()"], run: {simulated: {duration: 1s}}}
  b: {effects: ["+b()"], run: {simulated: {duration: 1s}}}
  go: {inputs: {who: {type: text}}, effects: ["+went({who})"], run: {simulated: {duration: 1s}}}
start: both
states:
  both:
    kind: preemptive
    outcomes: [a, b]
    on: {a: to_a, b: to_b}
    states:
      a: {on: {success: return a}}
      b: {on: {success: return b}}
  to_a: {action: go, inputs: {who: a}, on: {success: return success}}
  to_b: {action: go, inputs: {who: b}, on: {success: return success}}
)x";
  for (const std::string first : {"a", "b"}) {
    const auto journal = resumed(text, [&](mission::RunJournal& earlier) {
      earlier.ended({"both/a"}, {});
      earlier.ended({"both/b"}, {});
      earlier.first({"both/" + first});
    });
    EXPECT_THAT(VirtualRun(text, journal).executions().back(), HasSubstr("to_" + first));
  }
}

/// The resumed run meets again what aborted in the earlier one without having begun.
TEST(Races, AResumedRunDoesNotWaitForWhatCannotBegin) {
  const std::string text = R"x(
mission: m
actions:
  quick: {effects: ["+a()"], run: {simulated: {duration: 1s}}}
  stuck: {preconditions: ["never()"], effects: ["+b()"], run: {simulated: {duration: 1s}}}
  slow: {effects: ["+c()"], run: {simulated: {duration: 9s}}}
kind: preemptive
outcomes: [by_quick, by_slow]
states:
  quick: {on: {success: return by_quick}}
  other:
    on: {success: return by_slow}
    start: stuck
    states:
      stuck: {on: {success: slow, aborted: slow}}
      slow: {on: {success: return success}}
)x";
  const auto journal = resumed(text, [&](mission::RunJournal& earlier) {
    mission::RunJournal::End end;
    end.outcome = mission::kAborted;
    earlier.ended({"other/stuck"}, end);
  });
  const VirtualRun run(text, journal);
  EXPECT_EQ(run.result.outcome_name, "by_quick");
  EXPECT_EQ(run.network_result().makespan, std::chrono::seconds(1));
}

/// The variables that the loser set in the earlier run count, also where its way is known only after the
/// first has ended.
TEST(Races, AResumedRunKeepsWhatALoserHasDone) {
  const std::string text = R"x(
mission: m
actions:
  quick: {effects: ["+a()"], run: {simulated: {duration: 1s}}}
  choose: {pure: true, outcomes: [one, other, none], run: {simulated: {duration: 1s}}}
  slow: {pure: true, run: {simulated: {duration: 9s}}}
kind: preemptive
states:
  quick: {on: {success: return success}}
  other:
    start: choose
    states:
      choose: {on: {one: slow, other: slow, none: return success}}
      slow: {on: {success: return success}}
    on: {success: return success}
)x";
  auto options = resumed(text, [&](mission::RunJournal& earlier) {
    earlier.ended({"other/choose"}, {});
    earlier.ended({"quick"}, {});
    earlier.first({"quick"});
    mission::RunJournal::End end;
    end.outcome = mission::kPreempted;
    end.globals.set("started", type::Value(true));
    earlier.ended({"other/slow"}, end);
  });
  for (const std::uint32_t workers : {0U, 1U}) {
    options.workers = workers;
    const VirtualRun run(text, options);
    EXPECT_EQ(run.result.outcome_name, "success");
    EXPECT_EQ(run.globals().get("started"), type::Value(true)) << workers << " workers";
  }
}

TEST(Races, ALoopBesideAWatchEndsWithIt) {
  const VirtualRun run(R"x(
mission: m
actions:
  turn: {resources: [{block: base}], run: {simulated: {duration: 2s}}}
  watch: {effects: ["+seen()"], run: {simulated: {duration: 7s}}}
kind: preemptive
states:
  patrol:
    on: {success: return success}
    start: turn
    states:
      turn: {on: {success: turn}}
  watch: {on: {success: return success}}
)x");
  EXPECT_EQ(run.result.outcome_name, "success");
  EXPECT_EQ(run.network_result().makespan, std::chrono::seconds(7));
  const auto lines = run.executions();
  EXPECT_EQ(std::ranges::count_if(lines, [](const auto& line) { return line.starts_with("patrol/turn"); }),
            4);
}

}  // namespace
}  // namespace segue::convert
