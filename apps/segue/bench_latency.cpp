// SPDX-License-Identifier: Apache-2.0
// E1.1 and E1.2: how long samples take through a running chain.
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "bench_experiment.hpp"
#include "bench_floor.hpp"
#include "bench_robot.hpp"

namespace segue::cli {

namespace {

/// A period so long that a sample has arrived before the next one is written, on a busy machine too.
Duration period_of(const ChainOptions& chain) {
  const bool remote = chain.transport == BenchTransport::Remote;
  const auto hops = static_cast<std::int64_t>(chain.relays) + 1;
  const Duration a_hop = std::chrono::microseconds(remote ? 1000 : 300);
  const Duration a_byte = std::chrono::nanoseconds(remote ? 10 : 2);
  const Duration copies = a_byte * hops * static_cast<std::int64_t>(chain.bytes);
  return std::max<Duration>(std::chrono::milliseconds(2), a_hop * hops + copies);
}

std::string published_latency(const ChainOptions& chain) {
  if (chain.bytes > 1000) return {};
  switch (chain.transport) {
    case BenchTransport::Local:
      return "20 us a hop";
    case BenchTransport::SharedMemory:
      return "140 us a hop";
    default:
      return "220 us a hop";
  }
}

Result<std::vector<double>> latencies_of(BenchRobot& robot, const ChainOptions& chain,
                                         const BenchReport& report) {
  if (auto up = robot.switch_to(relay_chain(chain)); !up) return up.error();
  if (auto runs = robot.wait_for_samples(); !runs) return runs.error();
  if (auto reset = robot.call("consumer", "reset"); !reset) return reset.error();
  if (auto counted = robot.wait_for_count(chain.record, report.stopped); !counted) return counted.error();
  const auto latencies = robot.call("consumer", "latencies");
  if (!latencies) return latencies.error();
  std::vector<double> seconds;
  for (const type::Value& latency : latencies->as_list())
    seconds.push_back(latency.as_double());
  return seconds;
}

/// Nothing is known of the way to another computer.
Result<std::vector<double>> floor_of_latency(const ChainOptions& chain, const BenchHost& host,
                                             const BenchReport& report) {
  if (chain.transport == BenchTransport::Remote && !host.is_here()) return std::vector<double>{};
  const std::size_t bytes = std::max<std::size_t>(chain.bytes, 64);
  return pipe_latencies(chain.transport, chain.relays, bytes, chain.record, report.stopped);
}

Result<void> measure_latency(BenchRobot& robot, ChainOptions chain, const BenchHost& host,
                             const BenchReport& report) {
  chain.period = period_of(chain);
  auto seconds = latencies_of(robot, chain, report);
  if (!seconds) return seconds.error();
  if (auto down = robot.switch_to({}); !down) return down.error();
  auto floor = floor_of_latency(chain, host, report);
  if (!floor) return floor.error();
  if (seconds->empty()) return {};
  report.add({"latency", chain.transport, chain.relays, chain.bytes, std::move(*seconds), std::move(*floor),
              published_latency(chain)});
  return {};
}

Result<void> measure_all(const BenchSettings& settings, const std::vector<std::size_t>& relays,
                         const std::vector<std::size_t>& bytes, const BenchReport& report) {
  for (const BenchTransport transport : settings.transports) {
    auto robot = BenchRobot::open(transport, settings.host);
    if (!robot) return robot.error();
    for (const std::size_t count : relays) {
      for (const std::size_t size : bytes) {
        if (report.stopped()) return {};
        report.progress(
            fmt::format("{}: {} relays, {} samples", to_string(transport), count, settings.repetitions));
        ChainOptions chain{count,
                           transport,
                           Exchange::None,
                           size,
                           settings.repetitions,
                           {},
                           settings.host.name,
                           ChainPlacement::Alternating};
        if (auto done = measure_latency(**robot, chain, settings.host, report); !done) return done;
      }
    }
  }
  return {};
}

}  // namespace

Result<void> run_latency_by_length(const BenchSettings& settings, const BenchReport& report) {
  const std::vector<std::size_t> lengths = {1, 5, 10, 25, 50};
  return measure_all(settings, settings.relays.empty() ? lengths : settings.relays, {0}, report);
}

Result<void> run_latency_by_size(const BenchSettings& settings, const BenchReport& report) {
  const std::vector<std::size_t> sizes = {100, 10'000, 100'000, 1'000'000, 10'000'000};
  return measure_all(settings, settings.relays.empty() ? std::vector<std::size_t>{1} : settings.relays,
                     settings.bytes.empty() ? sizes : settings.bytes, report);
}

}  // namespace segue::cli
