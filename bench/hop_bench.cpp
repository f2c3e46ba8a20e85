// SPDX-License-Identifier: Apache-2.0
// The cost of a hop between two tasks: with a thread each, in a thread group, by policy, and by size of the
// payload.
#include "support/chain.hpp"
#include "support/floor.hpp"
#include "support/measure.hpp"

#include <cstdio>
#include <string>
#include <thread>

namespace {

using namespace bench;
using segue::BufferKind;
using segue::Policy;

constexpr std::size_t kRounds = 600;
constexpr auto kPause = std::chrono::milliseconds(1);  // until all threads sleep again

std::string policy_name(const Policy& policy) {
  return std::string(to_string(policy.kind));
}

/// One sample at a time through P -> R -> C, each with a thread of its own, which spins for so long before it
/// sleeps.
Summary own_threads(const Policy& policy, Duration spin = {}) {
  Bench bench;
  Source<Stamped> source;
  segue::Activity activity;
  activity.spin = spin;
  auto& relay = bench.run<Relay>("relay", activity);
  auto& sink = bench.run<Sink<Stamped>>("sink", activity);
  bench.connect(source.output, relay.input, policy);
  bench.connect(relay.output, sink.input, policy);
  std::vector<Duration> durations;
  for (std::uint64_t round = 1; round <= kRounds; ++round) {
    std::this_thread::sleep_for(kPause);
    source.output.write({now_ns(), round});
    wait_for([&] { return sink.arrived.load(std::memory_order_acquire) >= round; });
    durations.emplace_back(sink.last_ns.load() - sink.last_sent_ns.load());
  }
  return summarise(std::move(durations));
}

/// A chain of relays on one thread: from the begin of the first relay's update to the arrival at the sink.
Summary in_group(std::size_t relays, const Policy& policy) {
  Bench bench;
  Source<Stamped> source;
  segue::Activity group;
  group.thread = "group";
  Relay& first = bench.run<Relay>("r0", group);
  first.notes_time = true;  // the others only pass samples on
  bench.connect(source.output, first.input, policy);
  Relay* last = &first;
  for (std::size_t i = 1; i < relays; ++i) {
    Relay& next = bench.run<Relay>("r" + std::to_string(i), group);
    bench.connect(last->output, next.input, policy);
    last = &next;
  }
  auto& sink = bench.run<Sink<Stamped>>("sink", group);
  bench.connect(last->output, sink.input, policy);
  std::vector<Duration> durations;
  for (std::uint64_t round = 1; round <= kRounds; ++round) {
    source.output.write({now_ns(), round});
    wait_for([&] { return sink.arrived.load(std::memory_order_acquire) >= round; });
    durations.emplace_back(sink.last_ns.load() - first.updated_ns.load());
  }
  return summarise(std::move(durations));
}

/// One hop of a payload that is written in place and read in place.
Summary payload(std::size_t bytes) {
  Bench bench;
  Source<Blob> source;
  auto& sink = bench.run<Sink<Blob>>("sink");
  bench.connect(source.output, sink.input);
  source.output.prime(Blob{0, std::vector<std::uint8_t>(bytes)});
  std::vector<Duration> durations;
  for (std::uint64_t round = 1; round <= kRounds / 3; ++round) {
    std::this_thread::sleep_for(kPause);
    auto loan = source.output.loan();
    if (!loan) continue;
    loan->data[bytes / 2] = static_cast<std::uint8_t>(round);
    loan->sent_ns = now_ns();
    loan.publish();
    wait_for([&] { return sink.arrived.load(std::memory_order_acquire) >= round; });
    durations.emplace_back(sink.last_ns.load() - sink.last_sent_ns.load());
  }
  return summarise(std::move(durations));
}

/// The cost of the writer alone: no task has to be woken.
Summary write_and_read(const Policy& policy) {
  Source<Stamped> source;
  Sink<Stamped> sink;
  auto connection = segue::sample_link::connect(source.output, sink.input, policy);
  if (!connection) return {};
  constexpr std::size_t kBatch = 1000;
  return measure(300, [&] {
    Stamped sample;
    for (std::size_t i = 0; i < kBatch; ++i) {
      source.output.write({0, i});
      sink.input.read(sample);
    }
    keep(sample);
  });
}

void hops() {
  const Summary floor = futex_chain(2, kRounds, std::nullopt);
  Table table("P -> R -> C, a thread each, 16 bytes (two hops; floor: futexes hand over the same way)");
  table.add("floor: bare futex hand-over", floor, 1, floor.median);
  for (const Policy& policy :
       {Policy{}, Policy{BufferKind::Buffer, 10}, Policy{BufferKind::CircularBuffer, 10}}) {
    table.add("segue, " + policy_name(policy), own_threads(policy), 1, floor.median);
  }
  table.add("segue, data, threads spin for 10 ms", own_threads({}, segue::kLongestSpin), 1, floor.median);
  const Summary again = futex_chain(2, kRounds, std::nullopt);
  table.add("floor again", again, 1, floor.median);
  table.print();
}

void hops_on_one_processor() {
  std::thread pinned([] {
    pin_to(0);  // the tasks' threads inherit it
    const Summary floor = futex_chain(2, kRounds, 0);
    Table table("P -> R -> C, a thread each, all on one processor (two hops)");
    table.add("floor: bare futex hand-over", floor, 1, floor.median);
    table.add("segue, data", own_threads({}), 1, floor.median);
    table.print();
  });
  pinned.join();
}

void groups() {
  Table table("A chain in one thread group, for each hop");
  for (const std::size_t relays : {1U, 25U, 250U}) {
    table.add(std::to_string(relays) + " relays, data", in_group(relays, {}), relays);
  }
  table.add("250 relays, buffer of 10", in_group(250, {BufferKind::Buffer, 10}), 250);
  table.print();
}

void writes() {
  Table table("write() and read() in one thread, nobody woken, for each pair");
  for (const Policy& policy :
       {Policy{}, Policy{BufferKind::Buffer, 10}, Policy{BufferKind::CircularBuffer, 10}}) {
    table.add(policy_name(policy), write_and_read(policy), 1000);
  }
  table.print();
}

void payloads() {
  Table table("One hop by size, written and read in place (floor: 10 bytes)");
  const Summary floor = payload(10);
  table.add("10 B", floor, 1, floor.median);
  for (const auto& [name, bytes] :
       {std::pair{"1 kB", 1000UL}, {"1 MB", 1000000UL}, {"100 MB", 100000000UL}}) {
    table.add(name, payload(bytes), 1, floor.median);
  }
  table.print();
}

}  // namespace

int main() {
  hops();
  hops_on_one_processor();
  groups();
  writes();
  payloads();
}
