// SPDX-License-Identifier: Apache-2.0
// The cost of each action on a task of this process, without a runtime.
#include "support/chain.hpp"
#include "support/floor.hpp"
#include "support/measure.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace {

using namespace bench;
using segue::task::Task;

constexpr std::size_t kRepeats = 2000;

segue::TimePoint soon() {
  return segue::RealClock::instance().now() + std::chrono::seconds(5);
}

std::unique_ptr<Task> make_task(const std::string& id) {
  auto task = Task::create(id, std::make_unique<Relay>());
  if (!task) require(std::move(task.error()));
  return std::move(*task);
}

void life_cycle() {
  const auto task = make_task("relay");
  auto configure = [&] { require(task->configure(soon())); };
  auto start = [&] { require(task->start(soon())); };
  auto stop = [&] { require(task->stop(soon())); };
  auto cleanup = [&] { require(task->cleanup(soon())); };

  Table table("Life cycle of a port-driven task with a thread of its own");
  configure();
  start();
  stop();
  table.add("configure", measure(kRepeats, cleanup, configure));
  table.add("start", measure(
                         kRepeats,
                         [&] {
                           if (task->state() == segue::TaskState::Running) stop();
                         },
                         start));
  table.add("stop", measure(
                        kRepeats,
                        [&] {
                          if (task->state() != segue::TaskState::Running) start();
                        },
                        stop));
  table.add("cleanup", measure(
                           kRepeats,
                           [&] {
                             if (task->state() == segue::TaskState::PreOperational) configure();
                           },
                           cleanup));
  table.print();
}

void creation() {
  const Summary floor = bare_thread(500);
  Table table("Creating a task (floor: creating and joining a bare thread)");
  table.add("floor: bare thread", floor, 1, floor.median);
  std::unique_ptr<Task> task;
  table.add("create with its thread",
            measure(
                500, [&] { task.reset(); }, [&] { task = make_task("relay"); }),
            1, floor.median);
  table.add("create and destroy",
            measure(500,
                    [&] {
                      task = make_task("relay");
                      task.reset();
                    }),
            1, floor.median);
  table.print();
}

/// The time of connecting does not grow with the number of connections: measured with `others` connected
/// pairs.
void connecting(Table& table, std::size_t others) {
  std::vector<std::unique_ptr<Source<Stamped>>> sources;
  std::vector<std::unique_ptr<Sink<Stamped>>> sinks;
  std::vector<std::shared_ptr<segue::sample_link::PortConnection>> kept;
  for (std::size_t i = 0; i <= others; ++i) {
    sources.push_back(std::make_unique<Source<Stamped>>());
    sinks.push_back(std::make_unique<Sink<Stamped>>());
    if (i == others) break;
    auto connection = segue::sample_link::connect(sources[i]->output, sinks[i]->input, {});
    if (connection) kept.push_back(*connection);
  }
  std::shared_ptr<segue::sample_link::PortConnection> connection;
  auto connect = [&] {
    connection = segue::sample_link::connect(sources.back()->output, sinks.back()->input, {}).value();
  };
  auto disconnect = [&] {
    if (connection) connection->disconnect();
    connection.reset();
  };
  const std::string beside = " beside " + std::to_string(others) + " others";
  table.add("connect" + beside, measure(kRepeats, disconnect, connect));
  table.add("disconnect" + beside, measure(
                                       kRepeats,
                                       [&] {
                                         if (!connection) connect();
                                       },
                                       disconnect));
}

}  // namespace

int main() {
  life_cycle();
  creation();
  Table table("Connections within a process");
  for (const std::size_t others : {0U, 100U, 1000U})
    connecting(table, others);
  table.print();
}
