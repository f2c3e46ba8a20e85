// SPDX-License-Identifier: Apache-2.0
// The events that followers of a mission get, whichever way it runs: actions and containers that begin and
// end, and those that may not begin.
#include <segue/base/virtual_clock.hpp>
#include <segue/convert/concurrent_run.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission_engine/engine.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

namespace segue::convert {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::shared_ptr<const mission::Program> compiled(std::string_view text) {
  Diagnostics diagnostics;
  auto mission = mission::read_mission(text, "mission.yaml", diagnostics);
  EXPECT_TRUE(mission) << to_string(diagnostics);
  return mission::Program::compile(std::move(*mission)).value();
}

/// Collects the events of a run.
struct Told {
  std::vector<std::string> ends{};
  std::vector<std::string> of_containers{};
  std::vector<std::string> warnings{};

  [[nodiscard]] mission::StateObserver observer() {
    return [this](const mission::StateEvent& event) {
      const bool begins = event.kind == mission::StateEvent::Kind::Began;
      if (event.is_container) {
        of_containers.push_back(std::string(event.path) + "#" + std::to_string(event.iteration) +
                                (begins ? " began" : ": " + std::string(event.outcome)));
      }
      if (begins) return;
      std::string text = std::string(event.path) + ": " + std::string(event.outcome);
      if (!event.error.empty()) text += ", " + std::string(event.error);
      ends.push_back(std::move(text));
    };
  }
  [[nodiscard]] std::function<void(std::string)> warn() {
    return [this](std::string text) { warnings.push_back(std::move(text)); };
  }
};

Told told_sequentially(std::string_view text, const mission::Runners& runners = {}) {
  Told told;
  VirtualClock clock;
  mission::EngineOptions options;
  options.clock = &clock;
  options.observe = told.observer();
  options.warn = told.warn();
  const auto engine = mission::Engine::create(compiled(text), runners, options).value();
  EXPECT_EQ(engine->run(), mission::Engine::Progress::Ended);
  return told;
}

Told told_concurrently(std::string_view text, const mission::Runners& runners = {}) {
  Told told;
  RunOptions options;
  options.clock = task_network::ClockKind::Virtual;
  options.observe = told.observer();
  options.warn = told.warn();
  Run::create(compiled(text), runners, {}, options).value()->run();
  return told;
}

constexpr std::string_view kActions = R"x(
mission: m
world: [ready]
actions:
  grasp: {preconditions: ["at(table)"], run: {simulated: {duration: 1s}}}
  rest: {run: {simulated: {duration: 1s}}}
)x";

TEST(RefusedStates, AreToldAsAborted) {
  const std::string text = std::string(kActions) + R"x(start: grasp
states:
  grasp: {on: {success: return success, aborted: rest}}
  rest: {on: {success: shelf}}
  shelf:
    preconditions: [lit]
    start: rest
    states: {rest: {on: {success: return success}}}
    on: {success: return success, aborted: last}
  last: {action: grasp, on: {success: return success}}
)x";
  const auto as_expected = ElementsAre(HasSubstr("grasp: aborted, its precondition at(table) does not hold"),
                                       "rest: success", HasSubstr("shelf: aborted, its precondition lit"),
                                       HasSubstr("last: aborted, its precondition at(table) does not hold"));
  EXPECT_THAT(told_sequentially(text).ends, as_expected);
  EXPECT_THAT(told_concurrently(text).ends, as_expected);
}

/// The mission itself may not begin.
TEST(RefusedStates, AreToldWhereTheyEndTheMission) {
  const std::string text = std::string(kActions) + R"x(start: shelf
states:
  shelf:
    preconditions: [lit]
    start: rest
    states: {rest: {on: {success: return success}}}
    on: {success: return success}
)x";
  EXPECT_THAT(told_sequentially(text).ends, ElementsAre(HasSubstr("shelf: aborted, its precondition lit")));
  EXPECT_THAT(told_concurrently(text).ends, ElementsAre(HasSubstr("shelf: aborted, its precondition lit")));
}

/// `give_up` succeeds once `grasp` has been tried often enough.
TEST(RefusedStates, ThatAreTriedAgainAtOnceAreWarnedOf) {
  const std::string text = std::string(kActions) + R"x(  give_up: {run: {callback: give_up}}
start: grasp
states:
  grasp: {on: {success: return success, aborted: give_up}}
  give_up: {on: {success: return success, aborted: grasp}}
)x";
  for (const auto& run : {told_sequentially, told_concurrently}) {
    int tries = 0;
    mission::Runners runners;
    runners.add("give_up", [&](mission::ActionCall&) {
      return ++tries == 1100 ? mission::Ending{0, {}} : mission::Ending{mission::kAborted, "not yet"};
    });
    const Told told = run(text, runners);
    EXPECT_EQ(tries, 1100);
    EXPECT_THAT(told.warnings, ElementsAre(HasSubstr("grasp: has aborted 1000 times in a row"),
                                           HasSubstr("give_up: has aborted 1000 times in a row")));
  }
}

/// With both ways of running it: what was told of containers, in its order, and the result.
class ContainerEvents : public ::testing::Test {
 protected:
  static void expect(std::string_view states, const std::vector<std::string>& told) {
    const std::string text = std::string(kActions) + std::string(states);
    EXPECT_THAT(told_sequentially(text).of_containers, ::testing::ElementsAreArray(told));
    EXPECT_THAT(told_concurrently(text).of_containers, ::testing::ElementsAreArray(told));
  }
  static constexpr std::string_view kActions = R"x(
mission: m
actions:
  rest: {run: {simulated: {duration: 1s}}}
  work: {run: {simulated: {duration: 5s}}}
  fail: {run: {simulated: {duration: 1s, outcomes: [aborted]}}}
  turn: {outcomes: [on, out], run: {simulated: {duration: 1s, outcomes: [on, on, out]}}}
  judge: {run: {decide: [{outcome: success}]}}
)x";
};

TEST_F(ContainerEvents, TellOfTheOutcomeByWhichAContainerIsLeft) {
  expect(R"x(start: outer
states:
  outer:
    start: inner
    outcomes: [home]
    states:
      inner:
        start: rest
        states: {rest: {on: {success: last}}, last: {action: rest, on: {success: return success}}}
        on: {success: return home}
    on: {home: return success}
)x",
         {"outer#0 began", "outer/inner#0 began", "outer/inner#0: success", "outer#0: home"});
}

TEST_F(ContainerEvents, CountTheTurnsOfALoop) {
  expect(R"x(start: round
states:
  round:
    start: turn
    outcomes: [on, out]
    states: {turn: {on: {on: return on, out: return out}}}
    on: {on: round, out: return success}
)x",
         {"round#0 began", "round#0: on", "round#1 began", "round#1: on", "round#2 began", "round#2: out"});
}

TEST_F(ContainerEvents, EndABarrierWithTheLastOfItsStates) {
  expect(R"x(start: both
states:
  both:
    kind: barrier
    states:
      a: {start: rest, states: {rest: {on: {success: return success}}}}
      b: {start: work, states: {work: {on: {success: return success}}}}
      decider: {kind: decider, action: judge, on: {success: return success}}
    on: {success: return success}
)x",
         {"both#0 began", "both/a#0 began", "both/b#0 began", "both/a#0: success", "both/b#0: success",
          "both#0: success"});
}

TEST_F(ContainerEvents, SayWhatIsPreempted) {
  expect(R"x(start: both
states:
  both:
    kind: preemptive
    states:
      a: {start: rest, states: {rest: {on: {success: return success}}}, on: {success: return success}}
      b: {start: work, states: {work: {on: {success: rest}}, rest: {on: {success: return success}}},
          on: {success: return success}}
    on: {success: return success}
)x",
         {"both#0 began", "both/a#0 began", "both/b#0 began", "both/a#0: success", "both/b#0: preempted",
          "both#0: success"});
}

TEST_F(ContainerEvents, SayWhatIsAbortedAndWhy) {
  const std::string_view states = R"x(start: outer
states:
  outer:
    start: inner
    states:
      inner: {start: fail, states: {fail: {on: {success: return success}}}, on: {success: return success}}
    on: {success: return success, aborted: after}
  after: {start: fail, states: {fail: {on: {success: return success}}}, on: {success: return success}}
)x";
  expect(states, {"outer#0 began", "outer/inner#0 began", "outer/inner#0: aborted", "outer#0: aborted",
                  "after#0 began", "after#0: aborted"});
  const std::string text = std::string(kActions) + std::string(states);
  const auto with_reasons =
      ElementsAre("outer/inner/fail: aborted, simulated failure", "outer/inner: aborted, simulated failure",
                  "outer: aborted, simulated failure", "after/fail: aborted, simulated failure",
                  "after: aborted, simulated failure");
  EXPECT_THAT(told_sequentially(text).ends, with_reasons);
  EXPECT_THAT(told_concurrently(text).ends, with_reasons);
}

/// The root of a library has the path of the state that uses it.
TEST_F(ContainerEvents, TellOfALibraryOnce) {
  expect(R"x(libraries:
  L: {start: rest, states: {rest: {on: {success: return success}}}}
start: one
states:
  one: {library: L, on: {success: two}}
  two: {library: L, on: {success: return success}}
)x",
         {"one#0 began", "one#0: success", "two#0 began", "two#0: success"});
}

TEST_F(ContainerEvents, AreNotToldOfWhatNothingHappensIn) {
  expect("start: return success\nstates: {rest: {on: {success: return success}}}\n", {});
}

/// A state that may not begin is an event of the container around it, which has begun then.
TEST_F(ContainerEvents, BeginWithWhatMayNotBegin) {
  expect(R"x(start: outer
states:
  outer:
    start: inner
    states:
      inner:
        preconditions: [lit]
        start: rest
        states: {rest: {on: {success: return success}}}
        on: {success: return success, aborted: return success}
    on: {success: return success}
)x",
         {"outer#0 began", "outer/inner#0: aborted", "outer#0: success"});
}

/// Blocking units takes a node of its own in the network, whose end is not that of the container.
TEST_F(ContainerEvents, AreNotConfusedByTheUnitsThatAContainerHolds) {
  expect(R"x(start: shelf
states:
  shelf:
    resources: [{block: arm}]
    outcomes: [full]
    start: rest
    states: {rest: {on: {success: return full}}}
    on: {full: return success}
)x",
         {"shelf#0 began", "shelf#0: full"});
}

TEST_F(ContainerEvents, EndWithARunThatIsStopped) {
  const std::string text = std::string(kActions) + R"x(start: outer
states:
  outer: {start: work, states: {work: {on: {success: return success}}}, on: {success: return success}}
)x";
  const auto stop_at_begin = [](Told& told, const std::function<void()>& stop) {
    return [observe = told.observer(), stop](const mission::StateEvent& event) {
      observe(event);
      if (event.path == "outer/work" && event.kind == mission::StateEvent::Kind::Began) stop();
    };
  };
  const auto preempted = ElementsAre("outer#0 began", "outer#0: preempted");
  {
    Told told;
    VirtualClock clock;
    std::unique_ptr<mission::Engine> engine;
    mission::EngineOptions options;
    options.clock = &clock;
    options.observe = stop_at_begin(told, [&] { engine->stop(); });
    engine = mission::Engine::create(compiled(text), {}, options).value();
    EXPECT_EQ(engine->run(), mission::Engine::Progress::Ended);
    EXPECT_THAT(told.of_containers, preempted);
  }
  Told told;
  std::unique_ptr<convert::Run> run;
  RunOptions options;
  options.clock = task_network::ClockKind::Virtual;
  options.observe = stop_at_begin(told, [&] { run->stop(); });
  run = convert::Run::create(compiled(text), {}, {}, options).value();
  run->run();
  EXPECT_THAT(told.of_containers, preempted);
}

}  // namespace
}  // namespace segue::convert
