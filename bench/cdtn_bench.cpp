// SPDX-License-Identifier: Apache-2.0
// The cost of the engine per node: random layered graphs of trivial nodes, each after three of the previous
// layer. For comparison, in the same run, executors without worlds, resources, conditions or failures: arrays
// and counters in one thread, a plain thread pool, and oneTBB's flow graph, if it is installed, in one thread
// like the engine and in two.
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/task_network/concurrent_engine.hpp>
#include <segue/task_network/order.hpp>
#include <segue/task_network/simulated_environment.hpp>

#include <benchmark/benchmark.h>

#include <atomic>
#include <deque>
#include <random>
#include <thread>
#include <vector>

#ifdef SEGUE_BENCH_TBB
#include <oneapi/tbb/flow_graph.h>
#include <oneapi/tbb/global_control.h>
#endif

namespace {

using namespace segue;
using namespace segue::task_network;

constexpr std::uint32_t kLayer = 100;
constexpr std::uint32_t kDegree = 3;

using Before = std::vector<std::vector<std::uint32_t>>;

Before make_graph(std::uint32_t nodes) {
  std::mt19937 random(1);
  Before before(nodes);
  for (std::uint32_t i = kLayer; i < nodes; ++i) {
    const std::uint32_t layer = i / kLayer * kLayer;
    for (std::uint32_t k = 0; k < kDegree; ++k)
      before[i].push_back(layer - kLayer + static_cast<std::uint32_t>(random() % kLayer));
  }
  return before;
}

struct Graph {
  explicit Graph(std::uint32_t nodes) : before(make_graph(nodes)), after(nodes) {
    for (std::uint32_t i = 0; i < nodes; ++i) {
      for (const std::uint32_t from : before[i])
        after[from].push_back(i);
    }
  }
  Before before;
  Before after;
};

enum class Kind { Data, Facts };

/// Each node has either three inputs, or facts that determine the order: it changes one and relies on two.
TaskNetwork make_network(const Graph& graph, Kind kind) {
  TaskNetwork network;
  std::vector<FactId> facts;
  for (std::uint32_t i = 0; kind == Kind::Facts && i < kLayer; ++i)
    facts.push_back(*network.facts.intern("f(" + std::to_string(i) + ")"));
  const std::uint32_t port = network.names.intern("value");
  NodeSpec spec;
  spec.name = "node";
  for (std::uint32_t i = 0; i < graph.before.size(); ++i) {
    spec.inputs.clear();
    spec.preconditions.clear();
    spec.effects.clear();
    const std::uint32_t layer = i / kLayer;
    if (kind == Kind::Facts) spec.effects.push_back({facts[i % kLayer], layer % 2 == 0});
    for (const std::uint32_t from : graph.before[i]) {
      const std::uint32_t fact = from % kLayer;
      const std::uint32_t changed = fact < i % kLayer ? layer : layer - 1;  // where it was last
      if (kind == Kind::Data)
        spec.inputs.push_back({NodeId{from}, port, port});
      else if (fact != i % kLayer && spec.preconditions.size() < kDegree - 1)
        spec.preconditions.push_back({facts[fact], changed % 2 == 0});
    }
    network.append(spec);
  }
  return network;
}

void per_node(benchmark::State& state) {
  state.counters["per_node"] =
      benchmark::Counter(static_cast<double>(state.range(0)),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void append_nodes(benchmark::State& state, Kind kind) {
  const Graph graph(static_cast<std::uint32_t>(state.range(0)));
  for (auto _ : state)
    benchmark::DoNotOptimize(make_network(graph, kind));
  per_node(state);
}

void derive(benchmark::State& state, Kind kind) {
  const TaskNetwork network = make_network(Graph(static_cast<std::uint32_t>(state.range(0))), kind);
  for (auto _ : state)
    benchmark::DoNotOptimize(derive_order(network));
  per_node(state);
}

/// Virtual time; nodes take no time. Includes making the engine, which runs once, but not the network and its
/// order, which can be run again.
void run_engine(benchmark::State& state, Kind kind) {
  const TaskNetwork network = make_network(Graph(static_cast<std::uint32_t>(state.range(0))), kind);
  const Order order = derive_order(network);
  std::size_t bytes = 0;
  for (auto _ : state) {
    SimulatedEnvironment environment(network);
    ConcurrentEngine engine(network, order, environment);
    const RunResult result = engine.run();
    if (!result.done()) state.SkipWithError(to_string(*result.error).c_str());
    bytes = engine.bytes();
  }
  per_node(state);
  state.counters["bytes_per_node"] =
      static_cast<double>(network.bytes() + order.bytes() + bytes) / static_cast<double>(network.size());
}

/// Runs a network, including the time to make it and its order.
void run_once(benchmark::State& state, Kind kind) {
  const Graph graph(static_cast<std::uint32_t>(state.range(0)));
  for (auto _ : state) {
    const TaskNetwork network = make_network(graph, kind);
    const Order order = derive_order(network);
    SimulatedEnvironment environment(network);
    const RunResult result = ConcurrentEngine(network, order, environment).run();
    if (!result.done()) state.SkipWithError(to_string(*result.error).c_str());
  }
  per_node(state);
}

enum class Lack { Resource, Data, Condition, Fact };

/// The reason that nodes wait until the first one, which takes `duration`, has ended.
TaskNetwork make_crowd(Lack lack, std::int64_t waiting, Duration duration) {
  TaskNetwork network;
  NodeSpec holder;
  holder.name = "holder";
  holder.duration = duration;
  NodeSpec spec;
  spec.name = "waiting";
  const Claim arm{network.resources.intern("system:arm")};
  const Literal ready{*network.facts.intern("ready()"), true};
  switch (lack) {
    case Lack::Resource:
      holder.claims = spec.claims = {arm};
      holder.kind = spec.kind = ActionClass::Pure;
      break;
    case Lack::Data:
      spec.inputs = {{NodeId{0}, 0, 0}};
      break;
    case Lack::Condition:
      holder.branches = true;
      spec.conditions = {{NodeId{0}, kSuccess}};
      break;
    case Lack::Fact:
      holder.effects = spec.preconditions = {ready};
      break;
  }
  network.append(holder);
  for (std::int64_t i = 0; i < waiting; ++i)
    network.append(spec);
  return network;
}

/// Measures the real time from the start of one node to that of another.
class Stopwatch final : public Environment {
 public:
  Stopwatch(const TaskNetwork& network, NodeId first, NodeId last)
      : inner_(network), first_(first), last_(last) {}
  void start(NodeContext& context, Completions& completions) override {
    if (context.node() == last_) end_ = std::chrono::steady_clock::now();
    inner_.start(context, completions);
    if (context.node() == first_) begin_ = std::chrono::steady_clock::now();
  }
  void cancel(NodeId node, std::uint32_t attempt, Completions& completions) override {
    inner_.cancel(node, attempt, completions);
  }
  [[nodiscard]] double seconds() const { return std::chrono::duration<double>(end_ - begin_).count(); }

 private:
  SimulatedEnvironment inner_;
  NodeId first_;
  NodeId last_;
  std::chrono::steady_clock::time_point begin_;
  std::chrono::steady_clock::time_point end_;
};

/// A step of a chain of nodes, while other nodes wait until the end.
void step_beside_waiting(benchmark::State& state, Lack lack) {
  constexpr std::uint32_t kSteps = 10'000;
  TaskNetwork network = make_crowd(lack, state.range(0), std::chrono::seconds(kSteps + 1));
  const NodeId first{network.size()};
  NodeSpec spec;
  spec.name = "step";
  spec.kind = ActionClass::Pure;
  spec.duration = std::chrono::seconds(1);
  for (std::uint32_t i = 0; i < kSteps; ++i)
    spec.inputs = {{network.append(spec), 0, 0}};
  const Order order = derive_order(network);
  for (auto _ : state) {
    Stopwatch environment(network, first, NodeId{network.size() - 1});
    const RunResult result = ConcurrentEngine(network, order, environment).run();
    if (!result.done()) state.SkipWithError(to_string(*result.error).c_str());
    state.SetIterationTime(environment.seconds() / kSteps);
  }
}

/// Nodes that take turns with one resource: all wait until the first has ended, then run one after another.
void take_turns(benchmark::State& state) {
  const TaskNetwork network = make_crowd(Lack::Resource, state.range(0), std::chrono::seconds(1));
  const Order order = derive_order(network);
  for (auto _ : state) {
    SimulatedEnvironment environment(network);
    const RunResult result = ConcurrentEngine(network, order, environment).run();
    if (!result.done()) state.SkipWithError(to_string(*result.error).c_str());
  }
  per_node(state);
}

/// The baseline: the minimum that any executor must do.
void run_counters(benchmark::State& state) {
  const Graph graph(static_cast<std::uint32_t>(state.range(0)));
  for (auto _ : state) {
    std::vector<std::uint32_t> open(graph.before.size());
    std::vector<std::uint32_t> ready;
    for (std::uint32_t i = 0; i < open.size(); ++i) {
      open[i] = static_cast<std::uint32_t>(graph.before[i].size());
      if (open[i] == 0) ready.push_back(i);
    }
    std::size_t done = 0;
    while (!ready.empty()) {
      const std::uint32_t node = ready.back();
      ready.pop_back();
      ++done;
      for (const std::uint32_t next : graph.after[node]) {
        if (--open[next] == 0) ready.push_back(next);
      }
    }
    benchmark::DoNotOptimize(done);
  }
  per_node(state);
}

/// Two threads, one queue behind a mutex.
void run_pool(benchmark::State& state) {
  const Graph graph(static_cast<std::uint32_t>(state.range(0)));
  for (auto _ : state) {
    std::vector<std::atomic<std::uint32_t>> open(graph.before.size());
    std::deque<std::uint32_t> ready;
    for (std::uint32_t i = 0; i < open.size(); ++i) {
      open[i] = static_cast<std::uint32_t>(graph.before[i].size());
      if (graph.before[i].empty()) ready.push_back(i);
    }
    segue::Mutex mutex;
    segue::ConditionVariable changed;
    std::size_t left = open.size();
    const auto work = [&] {
      segue::Lock lock(mutex);
      for (;;) {
        changed.wait(mutex, [&] { return !ready.empty() || left == 0; });
        if (left == 0) return;
        const std::uint32_t node = ready.front();
        ready.pop_front();
        lock.unlock();
        std::vector<std::uint32_t> freed;
        for (const std::uint32_t next : graph.after[node]) {
          if (--open[next] == 0) freed.push_back(next);
        }
        lock.lock();
        ready.insert(ready.end(), freed.begin(), freed.end());
        if (--left == 0 || freed.size() > 1) changed.notify_all();
      }
    };
    std::thread other(work);
    work();
    other.join();
  }
  per_node(state);
}

#ifdef SEGUE_BENCH_TBB
/// A flow graph and how many of its nodes have run.
struct FlowGraph {
  using Step = oneapi::tbb::flow::continue_node<oneapi::tbb::flow::continue_msg>;
  explicit FlowGraph(const Graph& graph) {
    for (std::size_t i = 0; i < graph.before.size(); ++i)
      nodes.emplace_back(whole, [this](const auto&) { done.fetch_add(1, std::memory_order_relaxed); });
    for (std::size_t i = 0; i < graph.before.size(); ++i) {
      for (const std::uint32_t from : graph.before[i])
        oneapi::tbb::flow::make_edge(nodes[from], nodes[i]);
    }
  }
  void run(const Graph& graph) {
    for (std::size_t i = 0; i < graph.before.size(); ++i) {
      if (graph.before[i].empty()) nodes[i].try_put({});
    }
    whole.wait_for_all();
  }
  oneapi::tbb::flow::graph whole;
  std::deque<Step> nodes;
  std::atomic<std::size_t> done{0};
};

/// One graph that is run again and again, as run_engine runs one network with one order.
void run_tbb(benchmark::State& state, int threads) {
  const Graph graph(static_cast<std::uint32_t>(state.range(0)));
  const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                          static_cast<std::size_t>(threads));
  FlowGraph flow(graph);
  for (auto _ : state)
    flow.run(graph);
  per_node(state);
}

/// A graph that is made and run once, as run_once makes and runs a network.
void run_tbb_once(benchmark::State& state, int threads) {
  const Graph graph(static_cast<std::uint32_t>(state.range(0)));
  const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                          static_cast<std::size_t>(threads));
  for (auto _ : state)
    FlowGraph(graph).run(graph);
  per_node(state);
}
#endif

void sizes(benchmark::internal::Benchmark* bench) {
  bench->RangeMultiplier(10)->Range(1000, 1'000'000)->Unit(benchmark::kMillisecond)->UseRealTime();
}

void crowds(benchmark::internal::Benchmark* bench) {
  bench->Arg(0)->Arg(1000)->Arg(10'000)->Arg(100'000)->UseManualTime()->Iterations(5);
}

BENCHMARK(run_counters)->Apply(sizes);
BENCHMARK(run_pool)->Apply(sizes);
BENCHMARK_CAPTURE(run_engine, data, Kind::Data)->Apply(sizes);
BENCHMARK_CAPTURE(run_engine, facts, Kind::Facts)->Apply(sizes);
BENCHMARK_CAPTURE(run_once, data, Kind::Data)->Apply(sizes);
BENCHMARK_CAPTURE(run_once, facts, Kind::Facts)->Apply(sizes);
#ifdef SEGUE_BENCH_TBB
BENCHMARK_CAPTURE(run_tbb, one_thread, 1)->Apply(sizes);
BENCHMARK_CAPTURE(run_tbb, two_threads, 2)->Apply(sizes);
BENCHMARK_CAPTURE(run_tbb_once, one_thread, 1)->Apply(sizes);
BENCHMARK_CAPTURE(run_tbb_once, two_threads, 2)->Apply(sizes);
#endif
BENCHMARK_CAPTURE(append_nodes, data, Kind::Data)->Apply(sizes);
BENCHMARK_CAPTURE(derive, data, Kind::Data)->Apply(sizes);
BENCHMARK_CAPTURE(derive, facts, Kind::Facts)->Apply(sizes);
BENCHMARK(take_turns)->RangeMultiplier(10)->Range(1000, 100'000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(step_beside_waiting, resource, Lack::Resource)->Apply(crowds);
BENCHMARK_CAPTURE(step_beside_waiting, data, Lack::Data)->Apply(crowds);
BENCHMARK_CAPTURE(step_beside_waiting, condition, Lack::Condition)->Apply(crowds);
BENCHMARK_CAPTURE(step_beside_waiting, fact, Lack::Fact)->Apply(crowds);

}  // namespace

BENCHMARK_MAIN();
