// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/concurrent_run.hpp>
#include <segue/convert/test_support.hpp>
#include <segue/mission/mission_io.hpp>

#include <gtest/gtest.h>

#include <future>
#include <thread>

namespace segue::convert {
namespace {

/// Runs in virtual time; all actions are simulated.
std::unique_ptr<Run> ran(std::string_view text) {
  Diagnostics diagnostics;
  auto mission = mission::read_mission(text, "mission.yaml", diagnostics);
  EXPECT_TRUE(mission) << to_string(diagnostics);
  RunOptions options;
  options.clock = task_network::ClockKind::Virtual;
  auto run =
      Run::create(mission::Program::compile(std::move(*mission)).value(), mission::Runners{}, {}, options)
          .value();
  run->run();
  return run;
}

/// Seconds after the begin.
double start_of(const Run& run, std::string_view path) {
  const auto& network = run.plan().network();
  for (task_network::NodeId node{0}; task_network::index(node) < network.size();
       node = task_network::NodeId{task_network::index(node) + 1}) {
    if (run.plan()[node].path != path) continue;
    const auto& result = run.network_result().nodes[task_network::index(node)];
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

TEST(ConcurrentMission, ARoutineThatGoesOnForEverInVirtualTimeCanBeStopped) {
  Diagnostics diagnostics;
  auto mission = mission::read_mission(R"x(
mission: m
actions:
  again: {run: {callback: again}}
  wait: {run: {simulated: {duration: 1h}}}
kind: preemptive
states:
  loop:
    on: {success: return success}
    start: turn
    states:
      turn: {action: again, on: {success: turn}}
  wait: {on: {success: return success}}
)x",
                                       "mission.yaml", diagnostics);
  ASSERT_TRUE(mission) << to_string(diagnostics);
  std::promise<void> goes_on;
  int turns = 0;
  mission::Runners runners;
  runners.add("again", [&](mission::ActionCall&) {
    if (++turns == 100) goes_on.set_value();
    return mission::Ending{};
  });
  RunOptions options;
  options.clock = task_network::ClockKind::Virtual;
  const auto run =
      Run::create(mission::Program::compile(std::move(*mission)).value(), runners, {}, options).value();
  std::jthread stopper([&] {
    goes_on.get_future().wait();
    run->stop();
  });
  EXPECT_EQ(run->run().outcome, mission::kPreempted);
}

constexpr const char* kPacking = R"x(
mission: m
actions:
  box: {outputs: {n: int}, effects: ["+box()"], run: {simulated: {duration: 20ms, outputs: {n: 3}}}}
  tape: {effects: ["+tape()"], run: {simulated: {duration: 50ms}}}
  close: {inputs: {n: int}, preconditions: ["box()", "tape()"], effects: ["+closed()"], run: {simulated: {duration: 1s}}}
variables: {n: {type: int, default: 0}}
start: box
flows: [box.n -> variables.n, variables.n -> close.n]
states:
  box: {on: {success: tape}}
  tape: {on: {success: close}}
  close: {on: {success: return success}}
)x";

/// The actions that could begin, each time that everything was held; and those that had begun by then.
struct Steps {
  std::vector<std::vector<std::string>> next;
  std::vector<std::vector<std::string>> begun;
};

/// Runs the mission paused from the beginning; `go` is called each time that everything is held, on the
/// engine's thread or, with `elsewhere`, on another.
Steps run_paused(RunOptions options, const std::function<void(Run&, std::size_t held)>& go,
                 bool elsewhere = false) {
  Diagnostics diagnostics;
  auto mission = mission::read_mission(kPacking, "mission.yaml", diagnostics);
  EXPECT_TRUE(mission) << to_string(diagnostics);
  mission::Runners runners;
  Steps steps;
  std::vector<std::string> begun;
  Run* run = nullptr;
  std::vector<std::jthread> others;
  options.observe = [&](const mission::StateEvent& event) {
    if (event.kind == mission::StateEvent::Kind::Began) begun.emplace_back(event.path);
  };
  options.held = [&](const std::vector<std::string>& next) {
    steps.next.push_back(next);
    steps.begun.push_back(begun);
    if (elsewhere)
      others.emplace_back([&, held = steps.next.size()] { go(*run, held); });
    else
      go(*run, steps.next.size());
  };
  const auto made =
      Run::create(mission::Program::compile(std::move(*mission)).value(), runners, {}, options).value();
  run = made.get();
  run->pause();
  (void)run->run();
  others.clear();  // they use the run until they end
  steps.begun.push_back(begun);
  return steps;
}

TEST(ConcurrentMission, AStepBeginsOneActionOfAPausedRun) {
  using Names = std::vector<std::string>;
  for (const std::uint32_t workers : {0U, 1U, 4U}) {
    RunOptions options;
    options.clock = task_network::ClockKind::Virtual;
    options.workers = workers;
    const Steps steps = run_paused(options, [&](convert::Run& run, std::size_t) { run.step(); });
    EXPECT_EQ(steps.next, std::vector<Names>({{"box", "tape"}, {"tape"}, {"close"}}));
    EXPECT_EQ(steps.begun, std::vector<Names>({{}, {"box"}, {"box", "tape"}, {"box", "tape", "close"}}));
  }
}

TEST(ConcurrentMission, APauseInRealTimeEndsFromAnotherThread) {
  RunOptions options;
  options.clock = task_network::ClockKind::Real;
  const Steps steps = run_paused(
      options, [](convert::Run& run, std::size_t held) { held == 1 ? run.step() : run.stop(); }, true);
  EXPECT_EQ(steps.next.size(), 2U);
  EXPECT_EQ(steps.begun.back(), std::vector<std::string>({"box"}));
}

TEST(ConcurrentMission, APausedRunGoesOnOrIsStopped) {
  RunOptions options;
  options.clock = task_network::ClockKind::Virtual;
  const Steps resumed = run_paused(options, [](convert::Run& run, std::size_t) { run.resume(); });
  EXPECT_EQ(resumed.next.size(), 1U);
  EXPECT_EQ(resumed.begun.back().size(), 3U);
  const Steps stopped = run_paused(options, [](convert::Run& run, std::size_t) { run.stop(); });
  EXPECT_EQ(stopped.next.size(), 1U);
  EXPECT_TRUE(stopped.begun.back().empty());
  const Steps stepped = run_paused(options, [](convert::Run& run, std::size_t held) {
    run.step();
    if (held == 1) run.step();
  });
  EXPECT_EQ(stepped.next.size(), 2U) << "two steps at once";
}

TEST(ConcurrentMission, APlanRefusesWhatDoesNotFit) {
  Diagnostics diagnostics;
  auto mission = mission::read_mission(
      "mission: m\ninputs: {n: int}\nstart: return success\nstates: {}\nkind: hierarchy\n", "mission.yaml",
      diagnostics);
  ASSERT_TRUE(mission) << to_string(diagnostics);
  const auto program = mission::Program::compile(std::move(*mission)).value();
  const auto refused = [&](std::vector<type::Value> inputs, std::vector<mission::Fact> facts) {
    const auto plan = MissionPlan::create(program, std::move(inputs), facts);
    return plan ? ErrorCode::Internal : plan.error().code;
  };
  EXPECT_TRUE(MissionPlan::create(program, {type::Value(3)}));
  EXPECT_TRUE(MissionPlan::create(program, {type::Value()})) << "null is its default";
  EXPECT_EQ(refused({type::Value("three")}, {}), ErrorCode::TypeMismatch);
  EXPECT_EQ(refused({type::Value(3), type::Value(4)}, {}), ErrorCode::InvalidArgument);
  EXPECT_EQ(refused({}, {{true, "at", {"a,b"}, {}}}), ErrorCode::InvalidArgument);
  EXPECT_EQ(refused({}, {{true, "at", {"{place}"}, {}}}), ErrorCode::InvalidArgument);
}

/// The declaration of how an action is likely to end does not change how the mission ends.
TEST(ExpectedEnds, OfActionsThatAreExpectedToAbortDecideNothing) {
  for (const std::string expected : {"ok", "aborted", "preempted"}) {
    const testing::VirtualRun run(R"x(
mission: m
outcomes: [good]
actions:
  try: {effects: ["+tried"], outcomes: [ok], expect: {outcome: )x" +
                                  expected + R"x(}, run: {simulated: {duration: 1s, outcomes: [ok]}}}
  use: {preconditions: [tried], outcomes: [ok], run: {simulated: {duration: 1s}}}
start: try
states:
  try: {on: {ok: use}}
  use: {on: {ok: return good}}
)x");
    EXPECT_EQ(run.result.outcome, 0) << expected << ": " << run.result.error;
  }
}

}  // namespace
}  // namespace segue::convert
