// SPDX-License-Identifier: Apache-2.0
// Whole networks through the runtime: starting and stopping chains of relays, and exchanging half of a chain
// (the paper's experiments E2.1 and E2.3, in one process).
#include "support/chain.hpp"
#include "support/floor.hpp"
#include "support/measure.hpp"

#include <segue/runtime/runtime.hpp>
#include <segue/task_host/local_task_host.hpp>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <thread>
#include <utility>

SEGUE_COMPONENT(bench::Relay)

namespace {

using namespace bench;
using namespace segue;

constexpr std::size_t kRepeats = 30;

/// A chain r0 -> r1 -> ...; from `exchanged` on the relays have other names.
model::Network chain(std::size_t relays, std::size_t exchanged) {
  model::Network network;
  network.name = model::NetworkName("chain");
  auto id = [&](std::size_t i) { return model::TaskId((i >= exchanged ? "x" : "r") + std::to_string(i)); };
  for (std::size_t i = 0; i < relays; ++i) {
    model::Task task;
    task.id = id(i);
    task.component = model::ComponentName("bench::Relay");
    network.tasks.push_back(std::move(task));
    if (i == 0) continue;
    model::Connection connection;
    connection.from = {id(i - 1), "output"};
    connection.to = {id(i), "input"};
    network.connections.push_back(std::move(connection));
  }
  return network;
}

/// The chain's tasks in one thread group: no thread is made for each.
model::Network grouped(model::Network network) {
  for (model::Task& task : network.tasks) {
    task.activity = Activity{};
    task.activity->thread = "chain";
  }
  return network;
}

struct Robot {
  task_host::LibrarySet libraries;
  model::ComponentCatalog catalog;
  task_host::LocalTaskHost host{libraries, catalog};
  runtime::Runtime runtime{"bench", host, catalog};

  Robot() {
    for (auto& input : {"bench::Relay"}) {
      auto component = libraries.create(model::ComponentName(input));
      if (component) catalog.add(task_host::describe(**component));
    }
  }
  void to(const model::Network& network) {
    const auto result = runtime.switch_to(network);
    if (result.ok()) return;
    std::fprintf(stderr, "%s\n", result.why().c_str());
    std::exit(1);
  }
};

void bring_up(Table& table, const std::string& name, std::size_t relays, bool group) {
  Robot robot;
  model::Network network = chain(relays, relays);
  if (group) network = grouped(std::move(network));
  const model::Network nothing;
  // The baseline: as many bare threads, created and joined in sequence.
  const Summary floor = group ? Summary{} : measure(kRepeats, [&] {
    for (std::size_t i = 0; i < relays; ++i)
      std::thread([] {}).join();
  });
  const std::string size = std::to_string(relays) + " relays, " + name;
  table.add("up:   " + size,
            measure(
                kRepeats, [&] { robot.to(nothing); }, [&] { robot.to(network); }),
            1, floor.median);
  table.add("down: " + size,
            measure(
                kRepeats, [&] { robot.to(network); }, [&] { robot.to(nothing); }),
            1, floor.median);
}

void exchange(Table& table, std::size_t relays) {
  Robot robot;
  const model::Network before = chain(relays, relays);
  const model::Network after = chain(relays, relays / 2);
  robot.to(before);
  bool there = false;
  auto swap = [&] {
    robot.to(there ? before : after);
    there = !there;
  };
  table.add("exchange " + std::to_string(relays - relays / 2) + " of " + std::to_string(relays),
            measure(kRepeats, swap));
}

double seconds_of(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// How the time for each task grows with the size of the network: not at all where it is linear.
void curve() {
  std::printf("%8s %12s %12s %12s   (us for each task of a chain in one thread group)\n", "tasks", "up",
              "exchange", "down");
  for (const std::size_t relays : {10U, 100U, 1000U, 3000U, 10'000U}) {
    Robot robot;
    const model::Network before = grouped(chain(relays, relays));
    const model::Network after = grouped(chain(relays, relays / 2));
    const auto each = [&](const model::Network& network) {
      return seconds_of([&] { robot.to(network); }) * 1e6 / static_cast<double>(relays);
    };
    const double up = each(before);
    const double swap = each(after);
    std::printf("%8zu %12.1f %12.1f %12.1f\n", relays, up, swap, each({}));
  }
}

}  // namespace

/// `network_bench curve`: only the curve.
int main(int argc, char** argv) {
  curve();
  if (argc > 1 && std::string(argv[1]) == "curve") return 0;
  Table up("Bring-up and tear-down of a chain through the runtime (floor: as many bare threads)");
  for (const std::size_t relays : {25U, 50U, 250U})
    bring_up(up, "a thread each", relays, false);
  for (const std::size_t relays : {25U, 50U, 250U})
    bring_up(up, "one thread group", relays, true);
  up.print();
  Table table("Exchange of half a chain through the runtime, all tasks running");
  for (const std::size_t relays : {10U, 25U, 50U})
    exchange(table, relays);
  table.print();
}
