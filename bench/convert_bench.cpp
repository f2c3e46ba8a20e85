// SPDX-License-Identifier: Apache-2.0
// The cost of converting a mission to a task network, per node, ordering included: sequences, branches that
// join again, a continuing loop, hierarchies of ten. Each state reads an output of the previous one, and
// every second state changes a fact. The baseline follows the transitions of as many states and records each
// in flat arrays.
#include <segue/convert/mission_plan.hpp>
#include <segue/task_network/order_builder.hpp>

#include <benchmark/benchmark.h>
#include <malloc.h>

#include <array>
#include <ctime>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace segue;
using namespace segue::mission;

constexpr std::size_t kHorizon = 1000;

Action action(const std::string& name, std::vector<std::string> outcomes) {
  Action made;
  made.name = ActionName(name);
  made.inputs.push_back({"x", "int", 1, {}});
  made.outputs.push_back({"x", "int", {}, {}});
  made.outcomes = std::move(outcomes);
  made.run = Callback{"copy"};
  return made;
}

Fact fact(bool positive) {
  Fact made;
  made.predicate = "p";
  made.positive = positive;
  return made;
}

StateId id(std::size_t number) {
  return StateId("s" + std::to_string(number));
}

/// Kinds of states: 0 and 1 change a fact, 2 relies on it, 3 branches.
std::vector<Action> actions() {
  std::vector<Action> all{action("set", {"success"}), action("clear", {"success"}),
                          action("read", {"success"}), action("choose", {"left", "right"})};
  all[0].effects.push_back(fact(true));
  all[1].effects.push_back(fact(false));
  all[2].preconditions.push_back(fact(true));
  all[3].pure = true;
  return all;
}

ActionName kind_of(std::size_t number) {
  constexpr std::array<const char*, 4> kKinds{"set", "read", "clear", "set"};
  return ActionName(kKinds.at(number % 4));
}

State hierarchy(const StateId& name) {
  State state;
  state.id = name;
  state.kind = StateKind::Hierarchy;
  state.outcomes = {"success"};
  state.start = Target{id(0), {}};
  return state;
}

State leaf(std::size_t number, std::vector<StateTransition> transitions, const ActionName& what) {
  State state;
  state.id = id(number);
  state.action = what;
  state.transitions = std::move(transitions);
  return state;
}

Target next_of(std::size_t number, std::size_t states) {
  return number + 1 < states ? Target{id(number + 1), {}} : Target{StateId(), "success"};
}

/// A sequence of states; with `back` the last one leads to the first.
Mission row(std::size_t states, bool back = false) {
  Mission mission;
  mission.name = "m";
  mission.actions = actions();
  State root = hierarchy(StateId("m"));
  for (std::size_t i = 1; i < states; ++i)
    root.flows.push_back({{Owner::Child, id(i - 1), "x"}, {Owner::Child, id(i), "x"}, {}});
  mission.add(kNoState, std::move(root));
  for (std::size_t i = 0; i < states; ++i) {
    const Target to = back && i + 1 == states ? Target{id(0), {}} : next_of(i, states);
    mission.add(0, leaf(i, {{"success", to, {}}}, kind_of(i)));
  }
  return mission;
}

/// Repeatedly a decision and two alternatives.
Mission branches(std::size_t states) {
  Mission mission = row(states / 3 * 3);
  for (std::size_t i = 0; i + 2 < states / 3 * 3; i += 3) {
    const auto at = static_cast<StateIndex>(i + 1);
    mission.states[at].action = ActionName("choose");
    mission.states[at].transitions = {{"left", {id(i + 1), {}}, {}}, {"right", {id(i + 2), {}}, {}}};
    mission.states[at + 1].transitions = {{"success", next_of(i + 2, states / 3 * 3), {}}};
  }
  return mission;
}

Mission hierarchies(std::size_t states) {
  Mission mission = row(states / 10);
  const auto outer = static_cast<StateIndex>(mission.states.size());
  for (StateIndex i = 1; i < outer; ++i) {
    State& around = mission.states[i];
    around.kind = StateKind::Hierarchy;
    around.action = {};
    around.inputs = mission.actions.front().inputs;
    around.outputs = mission.actions.front().outputs;
    around.outcomes = {"success"};
    around.start = Target{id(0), {}};
    around.flows = {{{Owner::Inputs, {}, "x"}, {Owner::Child, id(0), "x"}, {}},
                    {{Owner::Child, id(9), "x"}, {Owner::Outputs, {}, "x"}, {}}};
    for (std::size_t child = 0; child < 10; ++child)
      mission.add(i, leaf(child, {{"success", next_of(child, 10), {}}}, kind_of(child)));
  }
  return mission;
}

/// Processor time of this thread, to reduce the influence of other programs.
double processor_time() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

std::size_t heap() {
  const auto info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

void convert_mission(benchmark::State& state, Mission (*make)(std::size_t), std::size_t size) {
  const auto nodes = static_cast<std::size_t>(state.range(0));
  const auto program = Program::compile(make(size == 0 ? nodes : size));
  if (!program) return state.SkipWithError(program.error().message.c_str());
  double planning = 0;
  double ordering = 0;
  std::size_t made = 0;
  double bytes = 0;
  for (auto _ : state) {
    const std::size_t before = heap();
    double begin = processor_time();
    const auto lap = [&begin] {
      const double now = processor_time();
      return now - std::exchange(begin, now);
    };
    auto plan = convert::MissionPlan::create(*program);
    task_network::Order order;
    task_network::OrderBuilder builder((*plan)->network(), order);
    while (!(*plan)->finished() && (*plan)->network().size() < nodes) {
      (*plan)->expand((*plan)->network(), kHorizon);
      planning += lap();
      builder.extend();
      ordering += lap();
    }
    made += order.size();
    state.PauseTiming();
    bytes = static_cast<double>(heap() - before) / static_cast<double>(order.size());
    plan = fail(ErrorCode::Cancelled, "done with");
    state.ResumeTiming();
  }
  const auto per_node = [&](double time) { return time * 1e9 / static_cast<double>(made); };
  state.counters["plan_ns_per_node"] = per_node(planning);
  state.counters["order_ns_per_node"] = per_node(ordering);
  state.counters["bytes_per_node"] = bytes;
}

void floor(benchmark::State& state) {
  const auto program = Program::compile(row(static_cast<std::size_t>(state.range(0))));
  struct Noted {
    StateIndex state = 0;
    std::uint32_t action = 0;
    std::uint32_t before = 0;
    std::uint32_t inputs = 0;
  };
  for (auto _ : state) {
    std::vector<Noted> noted;
    const CompiledState& root = (*program)->node(0);
    for (NextStep at = root.start; at.kind == NextStep::Kind::Child;) {
      const StateIndex child = root.children[at.child];
      const CompiledState& node = (*program)->node(child);
      const auto before = static_cast<std::uint32_t>(noted.size());
      noted.push_back({child, node.action, before, static_cast<std::uint32_t>(node.inputs.size())});
      at = node.next[2];
    }
    benchmark::DoNotOptimize(noted.data());
  }
  state.counters["per_node"] =
      benchmark::Counter(static_cast<double>(state.range(0)),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void sizes(benchmark::internal::Benchmark* bench) {
  bench->RangeMultiplier(10)->Range(1000, 1'000'000)->Unit(benchmark::kMillisecond);
}

Mission loop(std::size_t states) {
  return row(states, true);
}
Mission straight(std::size_t states) {
  return row(states);
}

BENCHMARK(floor)->Apply(sizes);
BENCHMARK_CAPTURE(convert_mission, straight, straight, 0)->Apply(sizes);
BENCHMARK_CAPTURE(convert_mission, branches, branches, 0)->Apply(sizes);
BENCHMARK_CAPTURE(convert_mission, loop_of_ten, loop, 10)->Apply(sizes);
BENCHMARK_CAPTURE(convert_mission, hierarchies, hierarchies, 0)->Apply(sizes);

}  // namespace

BENCHMARK_MAIN();
