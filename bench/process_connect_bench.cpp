// SPDX-License-Identifier: Apache-2.0
// The time from connecting two processes to the arrival of the first sample.
#include "process/fleet.hpp"
#include "process/joining.hpp"
#include "process/transport.hpp"
#include "support/chain.hpp"

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace bench;
using namespace segue;
using model::Action;
using model::ActionKind;

constexpr std::size_t kRepeats = 100;
constexpr std::size_t kOthers = 15;  ///< producers and consumers beside: all with all
constexpr std::size_t kMany = 10;    ///< producers and consumers beside, all with all: a hundred connections

std::vector<std::string> names(const std::string& stem, std::size_t count) {
  std::vector<std::string> made;
  for (std::size_t i = 0; i < count; ++i)
    made.push_back(stem + std::to_string(i));
  return made;
}

std::vector<Action> all_with_all(ActionKind kind, const std::vector<std::string>& producers,
                                 const std::vector<std::string>& consumers) {
  std::vector<Action> actions;
  for (const std::string& producer : producers) {
    for (const std::string& consumer : consumers)
      actions.push_back(on_connection(kind, producer, consumer));
  }
  return actions;
}

TimePoint soon() {
  return RealClock::instance().now() + std::chrono::seconds(30);
}

type::Value call(Fleet& fleet, const std::string& consumer, const char* operation) {
  auto answer = fleet.host().call(model::TaskId(consumer), operation, type::Value(type::ValueMap{}), soon());
  if (!answer) require(std::move(answer.error()));
  return std::move(*answer);
}

/// The moment when the last consumer has received its number of samples.
std::int64_t last_arrival(Fleet& fleet, const std::vector<std::string>& consumers, std::uint64_t samples) {
  std::int64_t last = 0;
  for (const std::string& consumer : consumers) {
    type::Value statistics = call(fleet, consumer, "statistics");
    while (statistics.find("count")->as_uint() < samples)
      statistics = call(fleet, consumer, "statistics");
    last = std::max(last, statistics.find("last_arrival")->as_int());
  }
  return last;
}

Summary connect(Fleet& fleet, const std::vector<std::string>& producers,
                const std::vector<std::string>& consumers) {
  const auto connects = all_with_all(ActionKind::Connect, producers, consumers);
  const auto disconnects = all_with_all(ActionKind::Disconnect, producers, consumers);
  std::vector<Duration> durations;
  for (std::size_t i = 0; i < kRepeats; ++i) {
    for (const std::string& consumer : consumers)
      call(fleet, consumer, "reset");
    const std::int64_t begin = clock_ns();
    fleet.perform(connects);
    durations.emplace_back(last_arrival(fleet, consumers, producers.size()) - begin);
    fleet.perform(disconnects);
  }
  return summarise(std::move(durations));
}

Summary disconnect(Fleet& fleet, const std::vector<std::string>& producers,
                   const std::vector<std::string>& consumers) {
  const auto connects = all_with_all(ActionKind::Connect, producers, consumers);
  const auto disconnects = all_with_all(ActionKind::Disconnect, producers, consumers);
  bool there = false;
  return measure(
      kRepeats,
      [&] {
        if (!std::exchange(there, true)) fleet.perform(connects);
      },
      [&] {
        if (std::exchange(there, false)) fleet.perform(disconnects);
      });
}

void deployed(Table& table) {
  const auto fleet = Fleet::open();
  fleet->perform(
      {on_process(ActionKind::Deploy, here("writers")), on_process(ActionKind::Deploy, here("readers"))});
  fleet->run("writers", names("p", kMany), "bench::Producer");
  fleet->run("readers", names("c", kMany), "bench::Consumer");
  table.add("segue, one", connect(*fleet, {"p0"}, {"c0"}));
  table.add("segue, 100 at once", connect(*fleet, names("p", kMany), names("c", kMany)));
  fleet->run("writers", names("other_p", kOthers), "bench::Producer");
  fleet->run("readers", names("other_c", kOthers), "bench::Consumer");
  fleet->perform(all_with_all(ActionKind::Connect, names("other_p", kOthers), names("other_c", kOthers)));
  const std::string beside = " beside " + std::to_string(kOthers * kOthers) + " others";
  table.add("segue, one" + beside, connect(*fleet, {"p0"}, {"c0"}));
  table.add("segue, 100 at once" + beside, connect(*fleet, names("p", kMany), names("c", kMany)));
  table.add("segue, taking one off", disconnect(*fleet, {"p0"}, {"c0"}));
  table.add("segue, taking 100 off", disconnect(*fleet, names("p", kMany), names("c", kMany)));
}

void peer(Table& table, Joining& joining, std::size_t topics) {
  const std::string name =
      joining.name() + (topics == 1 ? ", one" : ", " + std::to_string(topics) + " at once");
  const auto summary = run_pair(
      {}, [&](const End& end) { return joining.join(end, topics, topics == 1 ? 50 : 20); },
      [&](const End& end) { joining.offer(end, topics); });
  if (summary) {
    table.add(name, *summary);
  } else {
    table.note(name, "failed");
  }
}

}  // namespace

int main() {
  Table table("Connections between processes, until the first samples are there");
  // Peers first: their processes are forked from this one, which must have no threads then.
  if (const auto iceoryx = make_iceoryx_joining()) {
    const auto roudi = RouDi::start();
    for (const std::size_t topics : {1U, 100U}) {
      if (roudi) peer(table, *iceoryx, topics);
    }
    if (!roudi) table.note("left out: iceoryx", "its daemon iox-roudi did not start");
  } else {
    table.note("left out: iceoryx", "tools/setup --bench-peers installs it");
  }
  if (const auto cyclone = make_cyclone_joining()) {
    for (const std::size_t topics : {1U, 100U})
      peer(table, *cyclone, topics);
  } else {
    table.note("left out: Cyclone DDS", "tools/setup --bench-peers installs it");
  }
  deployed(table);
  table.print();
}
