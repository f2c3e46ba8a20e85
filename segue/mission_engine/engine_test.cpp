// SPDX-License-Identifier: Apache-2.0
#include <segue/base/virtual_clock.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission/world_effects.hpp>
#include <segue/mission_engine/engine.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <future>
#include <latch>
#include <string>
#include <thread>
#include <vector>

#include <unistd.h>

namespace segue::mission {
namespace {

using namespace std::chrono_literals;

Mission parsed(std::string_view text) {
  Diagnostics diagnostics;
  auto mission = read_mission(text, "m.yaml", diagnostics);
  EXPECT_TRUE(mission) << to_string(diagnostics);
  return mission ? std::move(*mission) : Mission{};
}

std::shared_ptr<const Program> compiled(Mission mission) {
  auto program = Program::compile(std::move(mission));
  EXPECT_TRUE(program) << to_string(program.error());
  return program ? *program : nullptr;
}

std::unique_ptr<Engine> engine_for(Mission mission, const Runners& runners, EngineOptions options = {}) {
  auto engine = Engine::create(compiled(std::move(mission)), runners, std::move(options));
  EXPECT_TRUE(engine) << to_string(engine.error());
  return std::move(*engine);
}

/// Ends every execution from a thread of its own; keeps them until it goes.
class Threads final : public ActionRunner {
 public:
  std::optional<Ending> start(ActionCall& call) override {
    const auto completer = call.defer([] {});
    std::vector<type::Value> outputs(call.outputs().begin(), call.outputs().end());
    threads_.emplace_back([completer, outputs] { completer({0, {}}, outputs); });
    return std::nullopt;
  }

 private:
  std::vector<std::jthread> threads_;
};

/// Ends when it is preempted, from another thread; says when it is under way.
class UntilPreempted final : public ActionRunner {
 public:
  std::optional<Ending> start(ActionCall& call) override {
    auto completer = std::make_shared<Completer>();
    *completer = call.defer([this, completer] {
      threads_.emplace_back([completer] { (*completer)({0, {}}, {}); });
    });
    began.count_down();
    return std::nullopt;
  }
  std::latch began{1};

 private:
  std::vector<std::jthread> threads_;
};

constexpr std::string_view kLeaf = "mission: m\nactions: {a: {run: {callback: a}}}\naction: a\n";

TEST(MissionEngine, RefusesAMissionWhoseActionsItCannotRun) {
  const auto engine = Engine::create(compiled(parsed(kLeaf)), Runners());
  ASSERT_FALSE(engine);
  EXPECT_EQ(engine.error().code, ErrorCode::NotFound);
}

TEST(MissionEngine, SimulatesWhatItIsToldTo) {
  VirtualClock clock;
  EngineOptions options;
  options.clock = &clock;
  Runners runners;
  runners.simulate_all();
  const auto engine = engine_for(parsed("mission: m\nactions: {a: {outcomes: [x, y], expect: {duration: 4s, "
                                        "outcome: y}, run: {callback: a}}}\naction: a\n"),
                                 runners, options);
  EXPECT_EQ(engine->run(), Engine::Progress::Ended);
  EXPECT_EQ(engine->result().outcome_name, "y");
  EXPECT_EQ(clock.now().time_since_epoch(), 4s);
}

TEST(MissionEngine, RefusesInputsThatAreNone) {
  const auto engine = engine_for(
      parsed("mission: m\nactions: {a: {inputs: {x: int}, run: {simulated: {}}}}\naction: a\n"), Runners());
  EXPECT_EQ(engine->set_input("y", 1).error().code, ErrorCode::NotFound);
  EXPECT_EQ(engine->set_input("x", "one").error().code, ErrorCode::TypeMismatch);
  EXPECT_TRUE(engine->set_input("x", 1));
  EXPECT_EQ(engine->start_at("nowhere").error().code, ErrorCode::NotFound);
}

TEST(MissionEngine, NeedsNoStackForDepth) {
  constexpr int kDepth = 100'000;
  Mission mission;
  mission.name = "deep";
  Action action;
  action.name = ActionName("a");
  action.run = Simulated{};
  mission.actions.push_back(action);
  StateIndex around = kNoState;
  for (int i = 0; i < kDepth; ++i) {
    State state;
    state.id = StateId("s");
    state.kind = StateKind::Hierarchy;
    state.outcomes = {"success"};
    state.start = Target{StateId("s"), {}};
    if (around != kNoState) state.transitions.push_back({"success", {StateId(), "success"}, {}});
    around = mission.add(around, std::move(state));
  }
  State leaf;
  leaf.id = StateId("s");
  leaf.action = action.name;
  leaf.transitions.push_back({"success", {StateId(), "success"}, {}});
  mission.add(around, std::move(leaf));
  const auto engine = engine_for(std::move(mission), Runners());
  EXPECT_EQ(engine->run(), Engine::Progress::Ended);
  EXPECT_EQ(engine->result().outcome, 0);
  EXPECT_EQ(engine->executions(), kDepth + 1U);
}

TEST(MissionEngine, RunsLibrariesWithoutExpandingThem) {
  // Each uses the one before twice: 2^16 executions of the innermost, 17 machines.
  std::string text =
      "mission: m\nlibrary: l16\nactions: {a: {run: {simulated: {}}}}\nlibraries:\n  l0: {action: a}\n";
  for (int i = 1; i <= 16; ++i) {
    const std::string inner = "library: l" + std::to_string(i - 1);
    text += "  l" + std::to_string(i) + ": {start: a, states: {a: {" + inner + ", on: {success: b}}, b: {" +
            inner + ", on: {success: return success}}}}\n";
  }
  EngineOptions options;
  options.history = false;
  const auto engine = engine_for(parsed(text), Runners(), options);
  EXPECT_EQ(engine->run(), Engine::Progress::Ended);
  EXPECT_GT(engine->executions(), 65'536U);
}

TEST(MissionEngine, IsEndedFromOtherThreads) {
  const auto runner = std::make_shared<Threads>();
  Runners runners;
  runners.add("a", runner);
  std::string text =
      "mission: m\nactions: {a: {run: {callback: a}}, d: {run: {simulated: {}}}}\nkind: barrier\nstates:\n";
  for (int i = 0; i < 50; ++i)
    text += "  s" + std::to_string(i) +
            ": {start: x, states: {x: {action: a, on: {success: y}}, y: {action: a, on: {success: return "
            "success}}}}\n";
  text += "  d: {kind: decider, on: {success: return success}}\n";
  const auto engine = engine_for(parsed(text), runners);
  EXPECT_EQ(engine->run(), Engine::Progress::Ended);
  EXPECT_EQ(engine->result().outcome_name, "success");
}

TEST(MissionEngine, IsStoppedFromAnotherThread) {
  const auto runner = std::make_shared<UntilPreempted>();
  Runners runners;
  runners.add("a", runner);
  const auto engine = engine_for(parsed(kLeaf), runners);
  std::jthread stopper([&] {
    runner->began.wait();
    engine->stop();
  });
  EXPECT_EQ(engine->run(), Engine::Progress::Ended);
  EXPECT_EQ(engine->result().outcome_name, "preempted");
}

TEST(MissionEngine, IsPausedFromAnotherThread) {
  Runners runners;
  std::latch looping(1);
  std::atomic<bool> first = true;
  runners.add("a", [&](ActionCall&) {
    if (first.exchange(false)) looping.count_down();
    return Ending{};
  });
  EngineOptions options;
  options.history = false;
  const auto engine = engine_for(
      parsed("mission: m\nactions: {a: {run: {callback: a}}}\nstart: a\nstates: {a: {on: {success: a}}}\n"),
      runners, options);
  std::jthread pauser([&] {
    looping.wait();
    engine->pause();
  });
  EXPECT_EQ(engine->run(), Engine::Progress::Held);
  EXPECT_EQ(engine->held_at(), std::vector<std::string>{"a"});
}

constexpr std::string_view kTwoInALoop =
    "mission: m\nactions: {a: {outcomes: [again, done], run: {callback: a}}}\nstart: x\noutcomes: [done]\n"
    "states: {x: {action: a, on: {again: y, done: return done}}, y: {action: a, on: {again: x, done: return "
    "done}}}\n";

TEST(MissionEngine, IsSteeredFromAnotherThreadWhileItIsHeld) {
  Runners runners;
  int executions = 0;
  runners.add("a", [&](ActionCall&) { return Ending{++executions < 4 ? 0 : 1, {}}; });
  const auto engine = engine_for(parsed(kTwoInALoop), runners);
  ASSERT_TRUE(engine->set_breakpoints({"y"}));
  EXPECT_EQ(engine->set_breakpoints({"z"}).error().code, ErrorCode::NotFound);
  EXPECT_EQ(engine->set_breakpoints({""}).error().code, ErrorCode::InvalidArgument);
  std::jthread other;
  std::vector<std::string> held;
  while (engine->run() == Engine::Progress::Held) {
    EXPECT_TRUE(engine->is_at_rest());
    held.push_back(engine->held_at().front());
    if (other.joinable()) other.join();
    other = std::jthread([&, to = held.size()] {
      engine->post([&, to] {
        if (to == 2) static_cast<void>(engine->set_breakpoints({}));
        to == 1 ? engine->step_over() : engine->resume();
      });
    });
    engine->wait_for_message();
  }
  EXPECT_EQ(executions, 4);
  EXPECT_EQ(held, (std::vector<std::string>{"y", "x"}));
}

TEST(MissionEngine, GoesOnElsewhereWhileAnActionRuns) {
  Runners runners;
  const auto runner = std::make_shared<UntilPreempted>();
  runners.add("a", runner);
  runners.add("b", [](ActionCall&) { return Ending{}; });
  const auto engine = engine_for(
      parsed("mission: m\nactions: {a: {run: {callback: a}}, b: {run: {callback: b}}}\nstart: x\nstates: {x: "
             "{action: a, on: {success: return success}}, y: {action: b, on: {success: return success}}}\n"),
      runners);
  std::jthread other([&] {
    runner->began.wait();
    engine->post([&] {
      EXPECT_EQ(engine->values_of("x").value().find("when")->as_string(), "running");
      EXPECT_EQ(engine->step_back().error().code, ErrorCode::InvalidState);
      EXPECT_TRUE(engine->go_on_at("y"));
    });
  });
  EXPECT_EQ(engine->run(), Engine::Progress::Ended);
  EXPECT_EQ(engine->result().outcome_name, "success");
}

TEST(MissionEngine, PassesBreakpointsThatAnEarlierRunHasPassed) {
  const auto file = std::filesystem::path(::testing::TempDir()) /
                    ("segue_breakpoints_" + std::to_string(::getpid()) + ".journal");
  std::filesystem::remove(file);
  const Mission mission = parsed(kTwoInALoop);
  int executions = 0;
  Runners runners;
  runners.add("a", [&](ActionCall&) { return Ending{++executions < 6 ? 0 : 1, {}}; });
  EngineOptions options;
  options.journal = RunJournal::create(file, mission, {}).value();
  {
    const auto engine = engine_for(mission, runners, options);
    ASSERT_TRUE(engine->set_breakpoints({"y"}));
    EXPECT_EQ(engine->run(), Engine::Progress::Held);
    engine->resume();
    EXPECT_EQ(engine->run(), Engine::Progress::Held);
    EXPECT_EQ(engine->go_on_at("x").error().code, ErrorCode::Unsupported);
    EXPECT_EQ(executions, 3);
    options.journal->close();
  }
  options.journal = RunJournal::resume(file, mission, false, UnderWay::Again).value();
  const auto engine = engine_for(mission, runners, options);
  ASSERT_TRUE(engine->set_breakpoints({"y"}));
  EXPECT_EQ(engine->run(), Engine::Progress::Held);
  EXPECT_EQ(executions, 3) << "held where the earlier run was, not before";
  EXPECT_EQ(engine->held_at(), std::vector<std::string>{"y"});
  ASSERT_TRUE(engine->set_breakpoints({}));
  engine->resume();
  EXPECT_EQ(engine->run(), Engine::Progress::Ended);
  EXPECT_EQ(executions, 6);
  std::filesystem::remove(file);
}

TEST(MissionEngine, OutlivedByACompleter) {
  std::optional<Completer> late;
  class Keeps final : public ActionRunner {
   public:
    explicit Keeps(std::optional<Completer>& late) : late_(late) {}
    std::optional<Ending> start(ActionCall& call) override {
      late_ = call.defer([] {});
      return std::nullopt;
    }

   private:
    std::optional<Completer>& late_;
  };
  Runners runners;
  runners.add("a", std::make_shared<Keeps>(late));
  EngineOptions options;
  options.preemption_grace = 1ms;
  auto engine = engine_for(parsed(kLeaf), runners, options);
  engine->stop();
  engine->run();
  engine->stop();
  EXPECT_EQ(engine->run(), Engine::Progress::Ended);
  engine.reset();
  if (late) (*late)({0, {}}, {});
}

TEST(MissionHistory, ForgetsTheEffectsOfWhatIsUndone) {
  Runners runners;
  VirtualClock clock;
  EngineOptions options;
  options.clock = &clock;
  options.backward = true;
  WorldEffects<std::string> effects;
  effects.on("+up", [](std::string& moves, auto) { moves += "up "; }).on("-up", [](std::string& moves, auto) {
    moves += "down ";
  });
  options.world_data.emplace("moves", world_data(std::string(), effects));
  const auto engine = engine_for(parsed("mission: m\nactions:\n"
                                        "  lift: {effects: ['+up'], run: {simulated: {}}}\n"
                                        "  lower: {effects: ['-up', '+down'], run: {simulated: {}}}\n"
                                        "start: lift\nstates:\n  lift: {on: {success: lower}}\n"
                                        "  lower: {on: {success: wait}}\n"
                                        "  wait: {action: lift, on: {success: return success}}\n"),
                                 runners, std::move(options));
  for (int i = 0; i < 3; ++i) {
    engine->step_into();
    ASSERT_EQ(engine->run(), Engine::Progress::Held);
  }
  EXPECT_EQ(engine->world().facts(), World::Facts{"down()"});
  ASSERT_TRUE(engine->step_back());
  EXPECT_EQ(engine->world().facts(), World::Facts{"up()"});
  EXPECT_EQ(*data_of<std::string>(engine->world().view(), "moves"), "up ") << "not done and done back";
}

TEST(MissionEngine, ObserversOfUnitsAreToldWhatAStepBackTakesBack) {
  EngineOptions options;
  options.backward = true;
  std::vector<std::string> told;
  options.observe_units = [&](const Execution& execution, const UnitChanges& changes) {
    for (const auto& [resource, change] : changes)
      told.push_back(execution.path + ": " + resource + " " + std::to_string(change));
  };
  const auto engine =
      engine_for(parsed("mission: m\nresources: {screws: {count: 9}, box: {count: 0}}\nactions:\n"
                        "  drill:\n"
                        "    resources: [{consume: screws, count: 2}, {create: box}]\n"
                        "    run: {simulated: {}}\n"
                        "start: one\nstates:\n"
                        "  one: {action: drill, on: {success: two}}\n"
                        "  two: {action: drill, on: {success: return success}}\n"),
                 Runners(), std::move(options));
  for (int i = 0; i < 2; ++i) {
    engine->step_into();
    ASSERT_EQ(engine->run(), Engine::Progress::Held);
  }
  ASSERT_TRUE(engine->step_back());
  EXPECT_EQ(told, (std::vector<std::string>{"one: screws -2", "one: box 1", "one: screws 2", "one: box -1"}));
  EXPECT_EQ(engine->units().counts().at("screws"), 9U);
}

TEST(MissionWorld, TellsTheNameOfAFactFromItsArguments) {
  EXPECT_EQ(parts_of("at(box,table)").arguments, (std::vector<std::string>{"box", "table"}));
  EXPECT_EQ(parts_of("at(box,table)").predicate, "at");
  EXPECT_TRUE(parts_of("up()").arguments.empty());
  EXPECT_EQ(parts_of("up").predicate, "up");
}

TEST(MissionGlobals, AreLockedByOneAtATime) {
  Globals globals;
  ASSERT_TRUE(globals.set("x", 1));
  const auto key = globals.lock("x", 0ms);
  ASSERT_TRUE(key);
  EXPECT_EQ(globals.set("x", 2).error().code, ErrorCode::PermissionDenied);
  EXPECT_EQ(globals.lock("x", 1ms).error().code, ErrorCode::DeadlineExceeded);
  EXPECT_EQ(globals.unlock("x", *key + 1).error().code, ErrorCode::PermissionDenied);
  EXPECT_EQ(globals.erase("x").error().code, ErrorCode::PermissionDenied);
  EXPECT_TRUE(globals.set("x", 3, *key));
  std::jthread next([&] { EXPECT_TRUE(globals.lock("x", 60s)); });
  EXPECT_TRUE(globals.unlock("x", *key));
  next.join();
  EXPECT_TRUE(globals.unlock("x", 0, true));
  EXPECT_EQ(globals.get("x"), type::Value(3));
  EXPECT_TRUE(globals.erase("x"));
  EXPECT_EQ(globals.get("x"), std::nullopt);
}

TEST(MissionGlobals, KeepTheirType) {
  Globals globals({{"x", "float", 1.0, {}}});
  EXPECT_TRUE(globals.set("x", 2));
  EXPECT_EQ(globals.set("x", "two").error().code, ErrorCode::TypeMismatch);
  EXPECT_EQ(globals.unlock("y", 1).error().code, ErrorCode::NotFound);
}

}  // namespace
}  // namespace segue::mission
