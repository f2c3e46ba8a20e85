// SPDX-License-Identifier: Apache-2.0
//
// The times that a concurrent run records, compared with what each action measured itself.
#include <segue/base/mutex.hpp>
#include <segue/convert/concurrent_run.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission_script/script_runner.hpp>

#include <gtest/gtest.h>

#include <chrono>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace segue::convert {
namespace {

using namespace std::chrono_literals;
using task_network::ClockKind;
using task_network::NodeResult;

/// Really slept: what is tested is that time is measured where it passes.
constexpr Duration kNap = 20ms;

/// The times that actions measured themselves, in the order of their ends.
class Stopwatch {
 public:
  struct Span {
    TimePoint begin;
    TimePoint end;
  };
  void nap() {
    const TimePoint begin = monotonic_now();
    RealClock::instance().sleep_until(begin + kNap);
    const Lock lock(mutex_);
    spans_.push_back({begin, monotonic_now()});
  }
  std::vector<Span> spans() const {
    const Lock lock(mutex_);
    return spans_;
  }

 private:
  mutable Mutex mutex_;
  std::vector<Span> spans_;
};

/// Naps in a thread of its own.
class Deferred final : public mission::ActionRunner {
 public:
  explicit Deferred(Stopwatch& stopwatch) : stopwatch_(stopwatch) {}
  std::optional<mission::Ending> start(mission::ActionCall& call) override {
    const auto completer = call.defer([] {});
    threads_.emplace_back([this, completer] {
      stopwatch_.nap();
      completer({}, {});
    });
    return std::nullopt;
  }

 private:
  Stopwatch& stopwatch_;
  std::vector<std::jthread> threads_;
};

/// Defers its end and then ends at once.
class Hasty final : public mission::ActionRunner {
 public:
  std::optional<mission::Ending> start(mission::ActionCall& call) override {
    (void)call.defer([] {});
    return mission::Ending{};
  }
};

/// A kind of action, as a mission file says it, and how long it takes at least.
struct Kind {
  const char* name;
  const char* run;
  bool subtree = false;        ///< in a subtree that runs as one node
  bool measures = true;        ///< by the stopwatch
  Duration in_virtual_time{};  ///< what it takes there
};
constexpr const char* kScript =
    R"({python: {text: "import time\ndef execute(self, inputs, outputs, gvm):\n  time.sleep(0.02)\n  return 0\n"}})";
const std::vector<Kind> kKinds = {
    {"blocking", "{callback: blocking}"},
    {"deferred", "{callback: deferred}"},
    {"script", kScript, false, false},
    {"simulated", "{simulated: {duration: 20ms}}", false, false, kNap},
    {"blocking_subtree", "{callback: blocking}", true},
    {"deferred_subtree", "{callback: deferred}", true},
    {"script_subtree", kScript, true, false},
    {"simulated_subtree", "{simulated: {duration: 20ms}}", true, false, kNap},
};
std::ostream& operator<<(std::ostream& out, const Kind& kind) {
  return out << kind.name;
}

/// Three naps one after another, because each relies on the one before or, as subtrees, on anything.
std::string three_naps(const Kind& kind) {
  std::string actions = "mission: m\nactions:\n";
  std::string states = "start: s1\nstates:\n";
  for (int i = 1; i <= 3; ++i) {
    const std::string n = std::to_string(i);
    actions += "  nap" + n + ": {effects: [\"+n" + n + "()\"], ";
    if (i > 1) actions += "preconditions: [\"n" + std::to_string(i - 1) + "()\"], ";
    actions += "run: " + std::string(kind.run) + "}\n";
    const std::string next = i == 3 ? "return success" : "s" + std::to_string(i + 1);
    const std::string on = "on: {success: " + next + "}";
    states += "  s" + n +
              (kind.subtree ? ": {kind: preemptive, " + on + ", states: {in: {action: nap" + n +
                                  ", on: {success: return success}}}}\n"
                            : ": {action: nap" + n + ", " + on + "}\n");
  }
  return actions + states;
}

using ConcurrentRun = Run;  // in a fixture, Run is a function of GoogleTest

class TimesSideBySide : public ::testing::Test {
 protected:
  TimesSideBySide() {
    runners_.add("blocking", [this](mission::ActionCall&) {
      stopwatch_.nap();
      return mission::Ending{};
    });
    runners_.add("deferred", std::make_shared<Deferred>(stopwatch_));
    runners_.set_scripts(std::make_shared<mission::ScriptRunner>());
  }

  std::unique_ptr<ConcurrentRun> prepare(const std::string& text, ClockKind clock) const {
    Diagnostics diagnostics;
    auto mission = mission::read_mission(text, "m.yaml", diagnostics);
    EXPECT_TRUE(mission) << to_string(diagnostics) << text;
    RunOptions options;
    options.clock = clock;
    return ConcurrentRun::create(mission::Program::compile(std::move(*mission)).value(), runners_, {},
                                 options)
        .value();
  }
  std::unique_ptr<ConcurrentRun> ran(const std::string& text, ClockKind clock) const {
    auto run = prepare(text, clock);
    const mission::MissionResult& result = run->run();
    EXPECT_EQ(result.outcome, 0) << result.error;
    return run;
  }
  static const NodeResult& node(const ConcurrentRun& run, std::string_view path) {
    const auto& nodes = run.network_result().nodes;
    std::uint32_t i = 0;
    while (run.plan()[task_network::NodeId{i}].path != path)
      ++i;
    return nodes.at(i);
  }

  Stopwatch stopwatch_;
  mission::Runners runners_;
};
class Times : public TimesSideBySide, public ::testing::WithParamInterface<Kind> {};

/// Expects the order of times that holds of every recorded run.
void expect_order(const ConcurrentRun& run) {
  const auto& result = run.network_result();
  for (const NodeResult& node : result.nodes) {
    EXPECT_LE(TimePoint{}, node.started);
    EXPECT_LE(node.started, node.ended);
    EXPECT_LE(node.ended, node.committed);
    EXPECT_LE(node.committed.time_since_epoch(), result.makespan);
  }
  for (std::uint32_t i = 0; i < result.nodes.size(); ++i) {
    for (const task_network::Dependency& dependency : run.order().before(task_network::NodeId{i})) {
      EXPECT_GE(result.nodes[i].started, result.nodes[task_network::index(dependency.from)].ended)
          << run.plan().network().label(task_network::NodeId{i});
    }
  }
}

TEST_P(Times, EveryBarIsAsLongAsItsActionMeasured) {
  const auto run = ran(three_naps(GetParam()), ClockKind::Real);
  expect_order(*run);
  const auto spans = stopwatch_.spans();
  for (std::uint32_t i = 0; i < 3; ++i) {
    const NodeResult& bar = run->network_result().nodes.at(i);
    EXPECT_GE(bar.ended - bar.started, kNap);
    if (GetParam().measures) {
      EXPECT_GE(bar.ended - bar.started, spans.at(i).end - spans.at(i).begin);
    }
  }
}

TEST_P(Times, TheMakespanIsThatOfTheRunAlone) {
  const auto run = prepare(three_naps(GetParam()), ClockKind::Real);
  stopwatch_.nap();  // no part of the run
  const TimePoint before = monotonic_now();
  EXPECT_EQ(run->run().outcome, 0);
  const Duration outside = monotonic_now() - before;
  EXPECT_LE(run->network_result().makespan, outside);
  EXPECT_GE(run->network_result().makespan, 3 * kNap);
}

TEST_P(Times, InVirtualTimeOnlySimulatedActionsTakeTime) {
  const auto run = ran(three_naps(GetParam()), ClockKind::Virtual);
  expect_order(*run);
  const Duration each = GetParam().in_virtual_time;
  for (int i = 0; i < 3; ++i) {
    const NodeResult& bar = run->network_result().nodes.at(static_cast<std::size_t>(i));
    EXPECT_EQ(bar.started.time_since_epoch(), i * each);
    EXPECT_EQ(bar.ended - bar.started, each);
  }
  EXPECT_EQ(run->network_result().makespan, 3 * each);
}

INSTANTIATE_TEST_SUITE_P(OfEveryKind, Times, ::testing::ValuesIn(kKinds),
                         [](const auto& kind) { return std::string(kind.param.name); });

/// Deferred and simulated naps side by side; what comes after relies on one of them each.
std::string side_by_side(const std::string& simulated) {
  return R"x(
mission: m
actions:
  real: {effects: ["+a()"], run: {callback: deferred}}
  simulated: {effects: ["+b()"], run: {simulated: {duration: )x" +
         simulated + R"x(}}}
  after_real: {preconditions: ["a()"], effects: ["+c()"], run: {callback: deferred}}
  after_simulated: {preconditions: ["b()"], effects: ["+d()"], run: {callback: deferred}}
start: real
states:
  real: {on: {success: simulated}}
  simulated: {on: {success: after_real}}
  after_real: {on: {success: after_simulated}}
  after_simulated: {on: {success: return success}}
)x";
}

TEST_F(TimesSideBySide, EachBarIsItsOwnAction) {
  const auto run = ran(side_by_side("50ms"), ClockKind::Real);
  expect_order(*run);
  EXPECT_GE(node(*run, "real").ended - node(*run, "real").started, kNap);
  EXPECT_GE(node(*run, "simulated").ended - node(*run, "simulated").started, 50ms);
  EXPECT_GE(node(*run, "after_simulated").ended.time_since_epoch(), 70ms);
}

TEST_F(TimesSideBySide, VirtualTimeStandsStillWhileARealActionGoesOn) {
  const auto run = ran(side_by_side("8s"), ClockKind::Virtual);
  expect_order(*run);
  const auto started = [&](std::string_view path) { return node(*run, path).started.time_since_epoch(); };
  EXPECT_EQ(node(*run, "real").ended, TimePoint{});
  EXPECT_EQ(started("after_real"), 0s);
  EXPECT_EQ(started("after_simulated"), 8s);
  EXPECT_EQ(run->network_result().makespan, 8s);
}

TEST_F(TimesSideBySide, VirtualTimeGoesOnAfterARunnerThatDefersAndEndsAtOnce) {
  runners_.add("deferred", std::make_shared<Hasty>());
  EXPECT_EQ(ran(side_by_side("8s"), ClockKind::Virtual)->network_result().makespan, 8s);
}

}  // namespace
}  // namespace segue::convert
