// SPDX-License-Identifier: Apache-2.0
// E1.1 and E1.2: how long samples take through a running chain.
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "bench_experiment.hpp"
#include "bench_floor.hpp"
#include "bench_rounds.hpp"

namespace segue::cli {

namespace {

/// How long the samples of a chain are measured at most, as in the paper.
constexpr Duration kLongestMeasurement = std::chrono::seconds(15);
constexpr std::size_t kFewestSamples = 3;

/// A period so long that a sample has arrived before the next one is written, on a busy machine too.
Duration period_of(const ChainOptions& chain) {
  const bool remote = chain.transport == BenchTransport::Remote;
  const auto hops = static_cast<std::int64_t>(chain.relays) + 1;
  const Duration a_hop = std::chrono::microseconds(remote ? 1000 : 300);
  const Duration a_byte = std::chrono::nanoseconds(remote ? 10 : 2);
  const Duration copies = a_byte * hops * static_cast<std::int64_t>(chain.bytes);
  return std::max<Duration>(std::chrono::milliseconds(2), a_hop * hops + copies);
}

std::string published_by_size(const ChainOptions& chain) {
  constexpr std::size_t kSmall = 1000;
  constexpr std::size_t kSeveralKilobytes = 10'000;
  if (chain.bytes > (chain.transport == BenchTransport::Local ? kSeveralKilobytes : kSmall)) return {};
  return chain.transport == BenchTransport::Remote ? "> 1 ms" : "< 1 ms";
}

std::string published_by_length(const ChainOptions& chain) {
  switch (chain.transport) {
    case BenchTransport::Local:
      return "0.02 ms a relay";
    case BenchTransport::SharedMemory:
      return "0.14 ms a relay";
    default:
      return "0.22 ms a relay";
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
Result<BenchFloor> floor_of_latency(const ChainOptions& chain, const BenchHost& host,
                                    const BenchReport& report) {
  if (chain.transport == BenchTransport::Remote && !host.is_here()) return BenchFloor{};
  return floor_on_processors([&](const Processors& processors) {
    return pipe_latencies(chain.transport, chain.relays, chain.bytes, chain.record, processors,
                          report.stopped);
  });
}

Result<void> measure_latency(BenchRobot& robot, ChainOptions chain, const std::string& published,
                             const BenchSettings& settings, const BenchReport& report) {
  chain.period = period_of(chain);
  const auto fitting = static_cast<std::size_t>(kLongestMeasurement / *chain.period);
  chain.record = std::min(settings.repetitions, std::max(fitting, kFewestSamples));
  report.progress(fmt::format("{}: {} samples", to_string(chain), chain.record));
  auto seconds = latencies_of(robot, chain, report);
  if (!seconds) return seconds.error();
  if (auto down = robot.switch_to({}); !down) return down.error();
  auto floor = floor_of_latency(chain, settings.host, report);
  if (!floor) return floor.error();
  if (seconds->empty()) return {};
  report.add({"latency", chain.transport, chain.relays, chain.bytes, std::move(*seconds), std::move(*floor),
              published});
  return {};
}

}  // namespace

void run_latency_by_size(const BenchSettings& settings, const BenchReport& report) {
  const auto chains = [&](BenchTransport transport) {
    auto all = chains_of(settings, transport, {1},
                         {10, 100, 1000, 10'000, 100'000, 1'000'000, 10'000'000, 100'000'000});
    for (ChainOptions& chain : all) {
      if (transport == BenchTransport::SharedMemory) chain.ends = ChainEnds::OwnProcesses;
    }
    return all;
  };
  for_each_chain(settings, report, chains, [&](BenchRobot& robot, const ChainOptions& chain) {
    return measure_latency(robot, chain, published_by_size(chain), settings, report);
  });
}

void run_latency_by_length(const BenchSettings& settings, const BenchReport& report) {
  const auto chains = [&](BenchTransport transport) { return chains_of(settings, transport, kPaperLengths); };
  for_each_chain(settings, report, chains, [&](BenchRobot& robot, const ChainOptions& chain) {
    return measure_latency(robot, chain, published_by_length(chain), settings, report);
  });
}

}  // namespace segue::cli
