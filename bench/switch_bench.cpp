// SPDX-License-Identifier: Apache-2.0
// Switches as seen by a user: the twelve transitions of the Artemis rover with actions that take time, and a
// 1 kHz task that is in no transition.
//
//   switch_bench [artemis|untouched [SWITCHES]]      default: both, and a thousand switches
#include "support/measure.hpp"
#include "support/robot.hpp"

#include <segue/runtime/embedded_robot.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/task_host/task_host.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <thread>

namespace {

using namespace bench;
using namespace segue;
namespace fs = std::filesystem;

constexpr const char* kArtemis = SEGUE_SOURCE_DIR "/examples/04_artemis/robot.yaml";

/// The longest actions of the paper's Table 6 are three camera stops of 1.2 to 1.9 s; others take tens of
/// milliseconds.
constexpr const char* kDurations = R"(stand_ins:
  default: {configure: 20ms, start: 3ms, stop: 8ms, cleanup: 5ms, rate: 0}
  camera_usb::Task: {configure: 150ms, start: 30ms, stop: 1.3s, cleanup: 20ms, rate: 0}
)";

/// The longest chain of actions that wait for each other, with the durations that were measured.
Duration critical_path(const runtime::SwitchResult& result) {
  std::map<int, Duration> end;
  Duration phase_begin{0};
  Duration last{0};
  model::Phase phase = model::Phase::Prepare;
  for (const auto& record : result.actions) {
    if (record.action.phase != phase) {
      phase = record.action.phase;
      phase_begin = last;
    }
    Duration begin = phase_begin;
    for (const int before : record.action.after)
      begin = std::max(begin, end[before]);
    end[record.action.id] = begin + record.took.value_or(record.duration);
    last = std::max(last, end[record.action.id]);
  }
  return last;
}

struct Mode {
  const char* name;
  model::Order order;
  bool ahead;
};

void artemis() {
  const Scratch scratch;
  runtime::EmbeddedOptions options;
  options.stand_in = true;
  options.stand_ins = scratch.write("durations.yaml", kDurations);
  auto robot = open(kArtemis, options);
  runtime::Runtime& runtime = robot.runtime();
  std::printf("\nArtemis, actions that take time: total / commit / critical path, ms\n%-42s%22s%24s%22s\n",
              "", "paper order", "seamless", "after look-ahead");
  const std::array modes = {Mode{"paper", model::Order::Paper, false},
                            Mode{"seamless", model::Order::Seamless, false},
                            Mode{"look-ahead", model::Order::Seamless, true}};
  for (const auto& from : runtime.controllers()) {
    for (const auto& to : runtime.controllers()) {
      if (from == to) continue;
      std::printf("%-42s", (from.str() + " -> " + to.str()).c_str());
      for (const Mode& mode : modes) {
        runtime.prepare({}).wait();
        done(runtime.switch_to(from));
        if (mode.ahead) runtime.prepare({to}).wait();
        runtime::RequestOptions request;
        request.order = mode.order;
        const auto result = runtime.switch_to(to, request);
        done(result);
        const auto ms = [](Duration duration) {
          return std::chrono::duration<double, std::milli>(duration).count();
        };
        std::printf("%8.0f /%5.0f /%5.0f ", ms(result.duration), ms(result.commit),
                    ms(critical_path(result)));
        std::fflush(stdout);
      }
      std::printf("\n");
    }
  }
  done(robot.shut_down());
}

/// A producer and a consumer at 1 kHz that every network has, and some of twenty relays.
model::Network random_network(std::mt19937& random, bool producer_alone) {
  model::Network network;
  network.name = model::NetworkName("random");
  const auto task = [&](const std::string& id, const char* component) {
    model::Task made;
    made.id = model::TaskId(id);
    made.component = model::ComponentName(component);
    network.tasks.push_back(std::move(made));
  };
  const auto connect = [&](const std::string& from, const std::string& to) {
    model::Connection made;
    made.from = {model::TaskId(from), "fixed_out"};
    made.to = {model::TaskId(to), "fixed_in"};
    network.connections.push_back(std::move(made));
  };
  task("producer", "bench::Producer");
  Activity& activity = network.tasks.back().activity.emplace();
  activity.trigger = Trigger::Periodic;
  activity.period = std::chrono::milliseconds(1);
  activity.scheduler = Scheduler::Fifo;  // as for control loops; otherwise it competes with the switches
  activity.priority = 40;
  activity.optional = true;
  task("consumer", "bench::Consumer");
  connect("producer", "consumer");
  model::Deployment worker;
  worker.process = model::ProcessName("worker");
  for (int i = 0; i < 20; ++i) {
    if (random() % 2 == 0) continue;
    const std::string id = "relay" + std::to_string(i);
    task(id, "bench::Relay");
    connect("producer", id);
    if (i % 2 == 0) worker.tasks.push_back({model::TaskId(id), id});
  }
  if (!worker.tasks.empty()) network.deployments.push_back(std::move(worker));
  if (producer_alone) {
    model::Deployment control;
    control.process = model::ProcessName("control");
    control.tasks.push_back({model::TaskId("producer"), "producer"});
    network.deployments.push_back(std::move(control));
  }
  return network;
}

struct Cycles {
  std::uint64_t run = 0;
  std::uint64_t missed = 0;
};

Cycles cycles_of(runtime::Runtime& runtime) {
  Cycles cycles;
  for (const auto& report : runtime.host().tasks()) {
    if (report.id == model::TaskId("producer")) cycles = {report.timing.cycles, report.timing.missed};
  }
  return cycles;
}

/// Its connections begin and end with every commit.
void untouched(runtime::TaskPlacement placement, bool producer_alone, const char* name, int switches) {
  const Scratch scratch;
  runtime::EmbeddedOptions options;
  options.placement = placement;
  options.log_level = LogLevel::Error;
  auto robot =
      open(scratch.write(
               "robot.yaml",
               "robot: segue-switch-bench\nhosts: {localhost: local}\nlibraries: [segue_components_bench]\n"),
           options);
  std::mt19937 random(20261122);
  done(robot.runtime().switch_to(random_network(random, producer_alone)));
  const Cycles before = cycles_of(robot.runtime());
  const TimePoint begin = RealClock::instance().now();
  for (int i = 0; i < switches; ++i)
    done(robot.runtime().switch_to(random_network(random, producer_alone)));
  const Duration busy = RealClock::instance().now() - begin;
  const Cycles between = cycles_of(robot.runtime());
  std::this_thread::sleep_for(busy);
  const Cycles after = cycles_of(robot.runtime());
  std::printf(
      "%s: %d random switches in %.1f s: %llu of %llu cycles missed; idle for as long: %llu of %llu\n", name,
      switches, std::chrono::duration<double>(busy).count(),
      static_cast<unsigned long long>(between.missed - before.missed),
      static_cast<unsigned long long>(between.run - before.run),
      static_cast<unsigned long long>(after.missed - between.missed),
      static_cast<unsigned long long>(after.run - between.run));
  done(robot.shut_down());
}

}  // namespace

int main(int argc, char** argv) {
  ::setenv("SEGUE_LIBRARY_PATH", SEGUE_BENCH_LIBRARIES, 0);
  ::setenv("SEGUE_DEPLOYMENT", SEGUE_BENCH_DEPLOYMENT, 0);
  const std::string what = argc > 1 ? argv[1] : "";
  if (what.empty() || what == "artemis") artemis();
  if (what.empty() || what == "untouched") {
    const int switches = argc > 2 ? std::atoi(argv[2]) : 1000;
    std::printf("\nA task at 1 kHz that no transition names\n");
    untouched(runtime::TaskPlacement::InProcess, false, "one process", switches);
    untouched(runtime::TaskPlacement::Processes, false, "two processes", switches);
    untouched(runtime::TaskPlacement::Processes, true, "in a process of its own", switches);
  }
}
