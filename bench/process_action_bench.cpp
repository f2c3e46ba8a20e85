// SPDX-License-Identifier: Apache-2.0
// The cost of processes and of actions in them.
#include "process/calls.hpp"
#include "process/fleet.hpp"

#include <cstdio>
#include <string>
#include <vector>

namespace {

using namespace bench;
using segue::model::Action;
using segue::model::ActionKind;

constexpr std::size_t kCalls = 2000;
constexpr std::size_t kProcesses = 30;
constexpr std::size_t kBatch = 25;
constexpr std::size_t kRounds = 200;

void deploy(Table& table, Fleet& fleet, const std::string& how, Duration floor) {
  const std::vector<Action> there = {on_process(ActionKind::Deploy, "process")};
  const std::vector<Action> gone = {on_process(ActionKind::Undeploy, "process")};
  std::vector<Duration> ups;
  std::vector<Duration> downs;
  for (std::size_t i = 0; i < kProcesses; ++i) {
    const std::int64_t begin = clock_ns();
    fleet.perform(there);
    const std::int64_t middle = clock_ns();
    fleet.perform(gone);
    if (i == 0) continue;  // the zygote is started, files are read for the first time
    ups.emplace_back(middle - begin);
    downs.emplace_back(clock_ns() - middle);
  }
  table.add("deploy, " + how, summarise(std::move(ups)), 1, floor);
  table.add("undeploy, " + how, summarise(std::move(downs)), 1, floor);
}

void processes(Duration floor, const Summary& bare) {
  Table table("A deployment process (floor: posix_spawn of /bin/true until it has ended)");
  table.add("floor: posix_spawn", bare, 1, floor);
  deploy(table, *Fleet::open(), "posix_spawn", floor);
  deploy(table, *Fleet::open(true), "from the zygote", floor);
  table.print();
}

std::vector<Action> of_all(ActionKind kind, std::size_t count) {
  std::vector<Action> actions;
  for (std::size_t i = 0; i < count; ++i)
    actions.push_back(on_task(kind, "relay" + std::to_string(i)));
  return actions;
}

/// Each action in turn, so that every task passes its whole life cycle.
void life_cycles(Table& table, Fleet& fleet, std::size_t count, Duration floor) {
  const std::string size = count == 1 ? ", one" : ", each of " + std::to_string(count) + " at once";
  for (const ActionKind kind :
       {ActionKind::Configure, ActionKind::Start, ActionKind::Stop, ActionKind::Cleanup}) {
    std::vector<Duration> durations;
    for (std::size_t round = 0; round < kRounds; ++round) {
      for (const ActionKind each :
           {ActionKind::Configure, ActionKind::Start, ActionKind::Stop, ActionKind::Cleanup}) {
        const auto actions = of_all(each, count);
        const std::int64_t begin = clock_ns();
        fleet.perform(actions);
        if (each == kind) durations.emplace_back(clock_ns() - begin);
      }
    }
    table.add(std::string(to_string(kind)) + size, summarise(std::move(durations)), count, floor);
  }
}

void actions(Table& table, Duration floor) {
  const auto fleet = Fleet::open();
  fleet->perform({on_process(ActionKind::Deploy, "process")});
  std::vector<Action> placed;
  for (std::size_t i = 0; i < kBatch; ++i)
    placed.push_back(place("relay" + std::to_string(i), "bench::Relay", "process"));
  fleet->perform(placed);
  life_cycles(table, *fleet, 1, floor);
  life_cycles(table, *fleet, kBatch, floor);
}

}  // namespace

int main() {
  // Measurements that fork come first, while there are no threads.
  const auto byte = byte_there_and_back(kCalls);
  const auto corba = omniorb_calls(kCalls);
  if (!byte) {
    std::fputs("no socket between processes\n", stderr);
    return 1;
  }
  const Summary bare = bare_spawn(kProcesses * 4);
  processes(bare.median, bare);
  Table table("Actions on tasks of another process (floor: a byte there and back over a Unix socket)");
  table.add("floor: a byte there and back", *byte, 1, byte->median);
  if (corba) {
    table.add("omniORB, a call without arguments (Unix socket)", *corba, 1, byte->median);
  } else {
    table.note("left out: omniORB",
               has_omniorb() ? "its calls failed" : "tools/setup --bench-peers installs it");
  }
  actions(table, byte->median);
  table.print();
}
