// SPDX-License-Identifier: Apache-2.0
#include "bench_rounds.hpp"

#include <segue/base/text.hpp>

#include <fmt/core.h>

#include <memory>
#include <utility>

namespace segue::cli {

namespace {

using Measure = std::function<Result<void>(BenchRobot&, const ChainOptions&)>;

/// Opens the robot where there is none.
Result<void> measure_chain(std::unique_ptr<BenchRobot>& robot, const ChainOptions& chain,
                           const BenchHost& host, const Measure& measure) {
  if (robot == nullptr) {
    auto opened = BenchRobot::open(chain.transport, host);
    if (!opened) return opened.error();
    robot = std::move(*opened);
  }
  if (auto measured = measure(*robot, chain); !measured) return measured;
  if (auto down = robot->switch_to({}); !down) return down.error();
  return {};
}

}  // namespace

std::vector<ChainOptions> chains_of(const BenchSettings& settings, BenchTransport transport,
                                    const std::vector<std::size_t>& relays,
                                    const std::vector<std::size_t>& bytes) {
  std::vector<ChainOptions> chains;
  for (const std::size_t count : settings.relays.empty() ? relays : settings.relays) {
    for (const std::size_t size : settings.bytes.empty() ? bytes : settings.bytes) {
      ChainOptions chain;
      chain.relays = count;
      chain.transport = transport;
      chain.bytes = size;
      chain.host = settings.host.name;
      chains.push_back(std::move(chain));
    }
  }
  return chains;
}

std::string to_string(const ChainOptions& chain) {
  return fmt::format("{}, {} relays, {}", to_string(chain.transport), chain.relays, format_size(chain.bytes));
}

void for_each_chain(const BenchSettings& settings, const BenchReport& report,
                    const std::function<std::vector<ChainOptions>(BenchTransport)>& chains,
                    const Measure& measure) {
  for (const BenchTransport transport : settings.transports) {
    std::unique_ptr<BenchRobot> robot;
    for (const ChainOptions& chain : chains(transport)) {
      if (report.stopped()) return;
      const auto measured = measure_chain(robot, chain, settings.host, measure);
      if (measured) continue;
      report.failed(to_string(chain) + ": " + segue::to_string(measured.error()));
      robot.reset();
    }
  }
}

}  // namespace segue::cli
