// SPDX-License-Identifier: Apache-2.0
// The cost of processes and of actions in them, on this computer and on another host.
#include "process/calls.hpp"
#include "process/fleet.hpp"
#include "support/hosts.hpp"

#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

namespace {

using namespace bench;
using segue::model::Action;
using segue::model::ActionKind;
using segue::model::DeploymentKey;
using segue::model::HostName;
using segue::model::ProcessName;

constexpr std::size_t kCalls = 2000;
constexpr std::size_t kProcesses = 30;
constexpr std::size_t kBatch = 25;
constexpr std::size_t kRounds = 200;

void deploy(Table& table, Fleet& fleet, const std::string& how, Duration floor) {
  const std::vector<Action> there = {on_process(ActionKind::Deploy, here("process"))};
  const std::vector<Action> gone = {on_process(ActionKind::Undeploy, here("process"))};
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
void life_cycles(Table& table, Fleet& fleet, std::size_t count, const std::string& how, Duration floor) {
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
    table.add(std::string(to_string(kind)) + size + how, summarise(std::move(durations)), count, floor);
  }
}

/// The processes' tasks pass their life cycles, one and many at once.
void actions(Table& table, Fleet& fleet, const DeploymentKey& process, const std::string& how,
             Duration floor) {
  fleet.perform({on_process(ActionKind::Deploy, process)});
  std::vector<Action> placed;
  for (std::size_t i = 0; i < kBatch; ++i)
    placed.push_back(place("relay" + std::to_string(i), "bench::Relay", process));
  fleet.perform(placed);
  life_cycles(table, fleet, 1, how, floor);
  life_cycles(table, fleet, kBatch, how, floor);
}

/// The cost of one way of messages without Segue.
struct Peers {
  Summary byte;
  std::optional<Summary> corba;
};

Peers measure_peers(Way way) {
  const auto byte = byte_there_and_back(way, kCalls);
  if (byte) return {*byte, omniorb_calls(way, kCalls)};
  std::fputs("no socket between processes\n", stderr);
  std::exit(1);
}

void add_peers(Table& table, const Peers& peers) {
  table.add("floor: a byte there and back", peers.byte, 1, peers.byte.median);
  if (peers.corba) {
    table.add("omniORB, a call without arguments", *peers.corba, 1, peers.byte.median);
  } else {
    table.note("left out: omniORB",
               has_omniorb() ? "its calls failed" : "tools/setup --bench-peers installs it");
  }
}

void on_another_host(Table& table, Duration floor) {
  const Hosts hosts({{"far"}});
  const DeploymentKey process{HostName("far"), ProcessName("process")};
  actions(table, *Fleet::open_on(hosts.over_tcp()), process, " (TCP, encrypted)", floor);
  actions(table, *Fleet::open_on(hosts.over_unix_sockets()), process, " (Unix socket)", floor);
}

}  // namespace

int main() {
  // Measurements that fork come first, while there are no threads.
  const Peers unix_socket = measure_peers(Way::UnixSocket);
  const Peers tcp = measure_peers(Way::Tcp);
  const Summary bare = bare_spawn(kProcesses * 4);
  processes(bare.median, bare);
  Table near("Actions on tasks of another process (floor and omniORB over a Unix socket)");
  add_peers(near, unix_socket);
  actions(near, *Fleet::open(), here("process"), "", unix_socket.byte.median);
  near.print();
  Table far("Actions on tasks of another host: runtime, daemon, process (floor and omniORB over TCP)");
  add_peers(far, tcp);
  on_another_host(far, tcp.byte.median);
  far.print();
}
