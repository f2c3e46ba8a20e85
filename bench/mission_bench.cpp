// SPDX-License-Identifier: Apache-2.0
// The cost of the mission engine per executed state: trivial actions, by size. The baseline calls as many
// functions through the same kind of pointer and copies one value each.
#include <segue/mission_engine/engine.hpp>

#include <benchmark/benchmark.h>

#include <string>

namespace {

using namespace segue;
using namespace segue::mission;

Action action(const std::string& name) {
  Action made;
  made.name = ActionName(name);
  made.inputs.push_back({"x", "int", 1, {}});
  made.outputs.push_back({"x", "int", {}, {}});
  made.run = Callback{"copy"};
  return made;
}

/// A hierarchy with a sequence of `states` states, each of which reads an output of the previous one.
Mission sequence(int states) {
  Mission mission;
  mission.name = "sequence";
  mission.actions.push_back(action("copy"));
  State root;
  root.id = StateId("sequence");
  root.kind = StateKind::Hierarchy;
  root.outcomes = {"success"};
  root.start = Target{StateId("s0"), {}};
  for (int i = 1; i < states; ++i) {
    const auto id = [](int n) { return StateId("s" + std::to_string(n)); };
    root.flows.push_back({{Owner::Child, id(i - 1), "x"}, {Owner::Child, id(i), "x"}, {}});
  }
  mission.add(kNoState, std::move(root));
  for (int i = 0; i < states; ++i) {
    State state;
    state.id = StateId("s" + std::to_string(i));
    state.action = ActionName("copy");
    Target to{StateId("s" + std::to_string(i + 1)), {}};
    if (i + 1 == states) to = Target{StateId(), "success"};
    state.transitions.push_back({"success", std::move(to), {}});
    mission.add(0, std::move(state));
  }
  return mission;
}

/// A sequence of hierarchies with ten states each.
Mission nested(int states) {
  Mission mission = sequence(states / 10);
  const auto outer = static_cast<StateIndex>(mission.states.size());
  for (StateIndex i = 1; i < outer; ++i) {
    mission.states[i].kind = StateKind::Hierarchy;
    mission.states[i].inputs = mission.actions.front().inputs;
    mission.states[i].outputs = mission.actions.front().outputs;
    mission.states[i].outcomes = {"success"};
    mission.states[i].start = Target{StateId("s0"), {}};
    for (int child = 0; child < 10; ++child) {
      State state;
      state.id = StateId("s" + std::to_string(child));
      state.action = ActionName("copy");
      Target to{StateId("s" + std::to_string(child + 1)), {}};
      if (child == 9) to = Target{StateId(), "success"};
      state.transitions.push_back({"success", std::move(to), {}});
      mission.add(i, std::move(state));
    }
  }
  return mission;
}

Ending copy(ActionCall& call) {
  call.outputs()[0] = call.inputs()[0];
  return {};
}

void run(benchmark::State& state, Mission mission, bool history) {
  Runners runners;
  runners.add("copy", copy);
  const auto program = Program::compile(std::move(mission));
  if (!program) return state.SkipWithError(program.error().message.c_str());
  std::uint64_t executions = 0;
  for (auto _ : state) {
    state.PauseTiming();
    EngineOptions options;
    options.history = history;
    auto engine = Engine::create(*program, runners, options);
    state.ResumeTiming();
    (*engine)->run();
    executions += (*engine)->executions();
    state.PauseTiming();
    engine->reset();
    state.ResumeTiming();
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(executions));
  state.counters["per_state"] = benchmark::Counter(static_cast<double>(executions),
                                                   benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void sequence_of(benchmark::State& state) {
  run(state, sequence(static_cast<int>(state.range(0))), true);
}
void sequence_without_history(benchmark::State& state) {
  run(state, sequence(static_cast<int>(state.range(0))), false);
}
void hierarchies(benchmark::State& state) {
  run(state, nested(static_cast<int>(state.range(0))), true);
}

void compile(benchmark::State& state) {
  const Mission mission = sequence(static_cast<int>(state.range(0)));
  for (auto _ : state)
    benchmark::DoNotOptimize(Program::compile(mission));
  state.SetItemsProcessed(state.iterations() * state.range(0));
}

void floor(benchmark::State& state) {
  const auto states = static_cast<std::size_t>(state.range(0));
  std::vector<type::Value> values(states + 1, type::Value(1));
  const std::vector<std::function<void(const type::Value&, type::Value&)>> functions(
      states, [](const type::Value& from, type::Value& to) { to = from; });
  for (auto _ : state) {
    for (std::size_t i = 0; i < states; ++i)
      functions[i](values[i], values[i + 1]);
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
  state.counters["per_state"] = benchmark::Counter(static_cast<double>(state.iterations() * state.range(0)),
                                                   benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

BENCHMARK(sequence_of)->RangeMultiplier(10)->Range(100, 1'000'000);
BENCHMARK(sequence_without_history)->RangeMultiplier(10)->Range(100, 1'000'000);
BENCHMARK(hierarchies)->RangeMultiplier(10)->Range(100, 1'000'000);
BENCHMARK(compile)->RangeMultiplier(10)->Range(1'000, 1'000'000);
BENCHMARK(floor)->RangeMultiplier(10)->Range(100, 1'000'000);

}  // namespace

BENCHMARK_MAIN();
