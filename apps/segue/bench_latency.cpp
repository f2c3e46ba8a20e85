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

/// So slow that a sample has arrived before the next one is written, on a busy machine too.
Duration period_of(std::size_t relays, std::size_t bytes) {
  const auto hops = static_cast<std::int64_t>(relays) + 1;
  const Duration copies = std::chrono::nanoseconds(2 * hops * static_cast<std::int64_t>(bytes));
  return std::max<Duration>(std::chrono::milliseconds(2), std::chrono::microseconds(300) * hops + copies);
}

std::string published_latency(const ChainOptions& chain) {
  if (chain.bytes > 1000) return {};
  return chain.transport == BenchTransport::Local ? "20 us a hop" : "140 us a hop";
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

Result<void> measure_latency(BenchRobot& robot, ChainOptions chain, const BenchReport& report) {
  chain.period = period_of(chain.relays, chain.bytes);
  auto seconds = latencies_of(robot, chain, report);
  if (!seconds) return seconds.error();
  if (auto down = robot.switch_to({}); !down) return down.error();
  const std::size_t bytes = std::max<std::size_t>(chain.bytes, 64);
  auto floor = pipe_latencies(chain.transport, chain.relays, bytes, chain.record, report.stopped);
  if (!floor) return floor.error();
  if (seconds->empty()) return {};
  report.add({"latency", chain.transport, chain.relays, chain.bytes, std::move(*seconds), std::move(*floor),
              published_latency(chain)});
  return {};
}

Result<void> measure_all(const BenchSettings& settings, const std::vector<std::size_t>& relays,
                         const std::vector<std::size_t>& bytes, const BenchReport& report) {
  for (const BenchTransport transport : settings.transports) {
    auto robot = BenchRobot::open(transport);
    if (!robot) return robot.error();
    for (const std::size_t count : relays) {
      for (const std::size_t size : bytes) {
        if (report.stopped()) return {};
        report.progress(
            fmt::format("{}: {} relays, {} samples", to_string(transport), count, settings.repetitions));
        ChainOptions chain{count, transport, Exchange::None, size, settings.repetitions, {}};
        if (auto done = measure_latency(**robot, chain, report); !done) return done;
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
