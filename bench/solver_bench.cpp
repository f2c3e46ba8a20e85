// SPDX-License-Identifier: Apache-2.0
// The time of the solver, by kind of change and size. An element is a task, a connection or a deployment of
// either network. The baseline does the minimum that any solver must: it looks up every name of both networks
// once.
#include <segue/solve/solve.hpp>

#include <benchmark/benchmark.h>

#include <string>
#include <unordered_map>

namespace {

using namespace segue;

enum class Change { None, All, Half, Properties };

constexpr int kTasksPerProcess = 10;

model::Task make_task(const std::string& id, int rate) {
  model::Task task;
  task.id = model::TaskId(id);
  task.component = model::ComponentName("bench::Relay" + std::to_string(id.size() % 7));
  task.properties.as_map().set("rate", rate);
  return task;
}

/// A chain with a branch at every other task; ten tasks a process. Tasks from `renamed` on have other names,
/// and so have their processes.
model::Network make_network(int tasks, int renamed, int rate) {
  model::Network network;
  const auto id = [&](int i) { return (i < renamed ? "task_number_" : "other_number_") + std::to_string(i); };
  for (int i = 0; i < tasks; ++i) {
    if (i % kTasksPerProcess == 0) {
      network.deployments.emplace_back();
      network.deployments.back().process = model::ProcessName("process_of_" + id(i));
    }
    network.tasks.push_back(make_task(id(i), rate));
    network.deployments.back().tasks.push_back({network.tasks.back().id, id(i)});
    if (i > 0)
      network.connections.push_back(
          {{model::TaskId(id(i - 1)), "out"}, {model::TaskId(id(i)), "in"}, {}, {}});
    if (i > 1 && i % 2 == 0) {
      network.connections.push_back(
          {{model::TaskId(id(i - 2)), "status"}, {model::TaskId(id(i)), "extra"}, {}, {}});
    }
  }
  return network;
}

model::Network target_of(int tasks, Change change) {
  switch (change) {
    case Change::All:
      return make_network(tasks, 0, 1);
    case Change::Half:
      return make_network(tasks, tasks / 2, 1);
    case Change::Properties:
      return make_network(tasks, tasks, 2);
    case Change::None:
      break;
  }
  return make_network(tasks, tasks, 1);
}

double elements(const model::Network& network) {
  return static_cast<double>(network.tasks.size() + network.connections.size() + network.deployments.size());
}

void report(benchmark::State& state, const model::Network& current, const model::Network& target) {
  const double all = elements(current) + elements(target);
  state.counters["per_element"] =
      benchmark::Counter(all, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void diff_networks(benchmark::State& state, Change change, model::Order order) {
  const int tasks = static_cast<int>(state.range(0));
  const model::Network current = make_network(tasks, tasks, 1);
  const model::Network target = target_of(tasks, change);
  const model::ComponentCatalog catalog;
  for (auto _ : state) {
    auto found = solve::diff(current, target, catalog, {order});
    if (!found) state.SkipWithError(found.error().message.c_str());
    benchmark::DoNotOptimize(found);
  }
  report(state, current, target);
}

void predict_network(benchmark::State& state) {
  const int tasks = static_cast<int>(state.range(0));
  const model::Network current = make_network(tasks, tasks, 1);
  const model::Network target = target_of(tasks, Change::Half);
  const auto transition = solve::diff(current, target, {});
  for (auto _ : state) {
    auto found = solve::predict(current, *transition, {});
    if (!found) state.SkipWithError(found.error().message.c_str());
    benchmark::DoNotOptimize(found);
  }
  report(state, current, target);
}

/// Hashes and looks up every name of the networks once.
void floor_of_hashing(benchmark::State& state) {
  const int tasks = static_cast<int>(state.range(0));
  const model::Network current = make_network(tasks, tasks, 1);
  const model::Network target = target_of(tasks, Change::Half);
  for (auto _ : state) {
    std::unordered_map<std::string_view, int> numbers;
    const auto use = [&](const std::string& name) { ++numbers[name]; };
    for (const model::Network* network : {&current, &target}) {
      for (const auto& task : network->tasks)
        use(task.id.str());
      for (const auto& process : network->deployments)
        use(process.process.str());
      for (const auto& connection : network->connections) {
        use(connection.from.task.str());
        use(connection.to.task.str());
      }
    }
    benchmark::DoNotOptimize(numbers);
  }
  report(state, current, target);
}

void sizes(benchmark::internal::Benchmark* benchmark) {
  benchmark->RangeMultiplier(10)->Range(10, 100000)->Unit(benchmark::kMicrosecond);
}

BENCHMARK(floor_of_hashing)->Apply(sizes);
BENCHMARK_CAPTURE(diff_networks, identical, Change::None, model::Order::Seamless)->Apply(sizes);
BENCHMARK_CAPTURE(diff_networks, all_replaced, Change::All, model::Order::Seamless)->Apply(sizes);
BENCHMARK_CAPTURE(diff_networks, half_exchanged, Change::Half, model::Order::Seamless)->Apply(sizes);
BENCHMARK_CAPTURE(diff_networks, properties_changed, Change::Properties, model::Order::Seamless)
    ->Apply(sizes);
BENCHMARK_CAPTURE(diff_networks, half_exchanged_paper, Change::Half, model::Order::Paper)->Apply(sizes);
BENCHMARK(predict_network)->Apply(sizes);

}  // namespace

BENCHMARK_MAIN();
