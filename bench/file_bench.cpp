// SPDX-License-Identifier: Apache-2.0
// The time to read, validate, write and compare network files, per task. The baseline of reading is libyaml
// parsing the same text into events.
#include <segue/model/files.hpp>
#include <segue/model/validate.hpp>

#include <benchmark/benchmark.h>
#include <yaml.h>

#include <string>

namespace {

using namespace segue;

constexpr int kTasksPerProcess = 10;

model::ComponentCatalog make_catalog() {
  using enum model::Direction;
  model::ComponentCatalog catalog;
  model::ComponentModel relay;
  relay.name = model::ComponentName("bench::Relay");
  const auto add_port = [&](const char* name, model::Direction direction) {
    model::PortModel port;
    port.name = name;
    port.direction = direction;
    port.type = "/int32_t";
    relay.ports.push_back(port);
  };
  add_port("in", Input);
  add_port("extra", Input);
  add_port("out", Output);
  add_port("status", Output);
  model::PropertyModel rate;
  rate.name = "rate";
  rate.type = "/int32_t";
  relay.properties.push_back(rate);
  catalog.add(relay);
  return catalog;
}

model::Task make_task(const std::string& id) {
  model::Task task;
  task.id = model::TaskId(id);
  task.component = model::ComponentName("bench::Relay");
  task.properties.as_map().set("rate", 10);
  return task;
}

/// The network of solver_bench: a chain with a branch at every other task, ten tasks per process, 1.5
/// connections per task.
model::Network make_network(int tasks) {
  model::Network network;
  network.name = model::NetworkName("bench");
  const auto id = [](int i) { return "task_number_" + std::to_string(i); };
  const auto connect = [&](int from, const char* output, int to, const char* input) {
    network.connections.push_back(
        {{model::TaskId(id(from)), output}, {model::TaskId(id(to)), input}, {}, {}});
  };
  for (int i = 0; i < tasks; ++i) {
    if (i % kTasksPerProcess == 0) {
      network.deployments.emplace_back();
      network.deployments.back().process = model::ProcessName("process_of_" + id(i));
    }
    network.tasks.push_back(make_task(id(i)));
    network.deployments.back().tasks.push_back({network.tasks.back().id, id(i)});
    if (i > 0) connect(i - 1, "out", i, "in");
    if (i > 1 && i % 2 == 0) connect(i - 2, "status", i, "extra");
  }
  return network;
}

void report(benchmark::State& state) {
  const auto tasks = static_cast<double>(state.range(0));
  state.counters["per_task"] =
      benchmark::Counter(tasks, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

std::string text_of(const benchmark::State& state) {
  return model::write_network(make_network(static_cast<int>(state.range(0))));
}

void floor_of_events(benchmark::State& state) {
  const std::string text = text_of(state);
  for (auto _ : state) {
    yaml_parser_t parser;
    yaml_parser_initialize(&parser);
    yaml_parser_set_input_string(&parser, reinterpret_cast<const unsigned char*>(text.data()), text.size());
    for (bool more = true; more;) {
      yaml_event_t event;
      more = yaml_parser_parse(&parser, &event) != 0 && event.type != YAML_STREAM_END_EVENT;
      yaml_event_delete(&event);
    }
    yaml_parser_delete(&parser);
  }
  report(state);
}

void read(benchmark::State& state) {
  const std::string text = text_of(state);
  for (auto _ : state) {
    Diagnostics diagnostics;
    auto network = model::read_network(text, "controllers/bench.yaml", diagnostics);
    if (!network || !diagnostics.empty()) state.SkipWithError("the file is not read");
    benchmark::DoNotOptimize(network);
  }
  report(state);
}

void validate(benchmark::State& state) {
  const model::Network network = make_network(static_cast<int>(state.range(0)));
  const model::ComponentCatalog catalog = make_catalog();
  for (auto _ : state) {
    const Diagnostics found = model::validate(network, catalog, model::Depth::Full);
    if (found.has_errors()) state.SkipWithError("the network is not valid");
  }
  report(state);
}

void write(benchmark::State& state) {
  const model::Network network = make_network(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    auto text = model::write_network(network);
    benchmark::DoNotOptimize(text);
  }
  report(state);
}

void compare(benchmark::State& state) {
  const model::Network a = make_network(static_cast<int>(state.range(0)));
  const model::Network b = a;
  for (auto _ : state) {
    if (!equivalent(a, b)) state.SkipWithError("equal networks are not equivalent");
  }
  report(state);
}

void sizes(benchmark::internal::Benchmark* benchmark) {
  benchmark->RangeMultiplier(10)->Range(100, 100000)->Unit(benchmark::kMicrosecond);
}

BENCHMARK(floor_of_events)->Apply(sizes);
BENCHMARK(read)->Apply(sizes);
BENCHMARK(validate)->Apply(sizes);
BENCHMARK(write)->Apply(sizes);
BENCHMARK(compare)->Apply(sizes);

}  // namespace

BENCHMARK_MAIN();
