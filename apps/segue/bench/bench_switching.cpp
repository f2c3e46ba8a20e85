// SPDX-License-Identifier: Apache-2.0
// E2.1 and E2.3: bringing up, taking down and exchanging chains.
#include <fmt/core.h>

#include <array>
#include <utility>

#include "bench_experiment.hpp"
#include "bench_floor.hpp"
#include "bench_rounds.hpp"

namespace segue::cli {

namespace {

model::Order order_of(const BenchSettings& settings) {
  return settings.order.value_or(model::Order::Seamless);
}

Result<BenchFloor> floor_of(const ChainOptions& chain, const BenchSettings& settings,
                            const BenchReport& report) {
  if (chain.transport == BenchTransport::Remote && !settings.host.is_here()) return BenchFloor{};
  return floor_on_processors([&](const Processors& processors) -> Result<std::vector<double>> {
    if (chain.transport == BenchTransport::Local)
      return thread_starts(chain.relays + 2, settings.repetitions, processors, report.stopped);
    const std::size_t count = relay_chain(chain).deployments.size();
    return program_runs(count, settings.repetitions, processors, report.stopped);
  });
}

void show(const BenchReport& report, const ChainOptions& chain, const std::string& what,
          std::size_t repetition) {
  report.progress(fmt::format("{}: {}, repetition {}", to_string(chain), what, repetition + 1));
}

/// Rows with the same parameters, in the order in which they are first used; those without values are left
/// out.
class Rows {
 public:
  explicit Rows(const ChainOptions& chain) : chain_(chain) {}
  BenchRow& row(const std::string& what) {
    for (BenchRow& row : rows_) {
      if (row.what == what) return row;
    }
    rows_.push_back({what, chain_.transport, chain_.relays, chain_.bytes, {}, {}, {}});
    return rows_.back();
  }
  void add_to(const BenchReport& report) {
    for (BenchRow& row : rows_) {
      if (!row.seconds.empty()) report.add(std::move(row));
    }
  }

 private:
  ChainOptions chain_;
  std::vector<BenchRow> rows_;
};

std::string published_bring_up(const ChainOptions& chain) {
  if (chain.relays != 25) return {};
  switch (chain.transport) {
    case BenchTransport::Local:
      return "some ms";
    case BenchTransport::SharedMemory:
      return "> 1 s";
    default:
      return "> 1.5 s";
  }
}

Result<void> measure_bring_up(BenchRobot& robot, const ChainOptions& chain, const BenchSettings& settings,
                              const BenchReport& report) {
  Rows rows(chain);
  for (std::size_t i = 0; i < settings.repetitions && !report.stopped(); ++i) {
    show(report, chain, "bring-up", i);
    const auto up = robot.switch_to(relay_chain(chain), order_of(settings));
    if (!up) return up.error();
    if (auto runs = robot.wait_for_samples(); !runs) return runs;
    const auto down = robot.switch_to({}, order_of(settings));
    if (!down) return down.error();
    rows.row("bring-up").seconds.push_back(up->seconds);
    rows.row("tear-down").seconds.push_back(down->seconds);
  }
  auto floor = floor_of(chain, settings, report);
  if (!floor) return floor.error();
  rows.row("bring-up").floor = std::move(*floor);
  rows.row("bring-up").published = published_bring_up(chain);
  rows.add_to(report);
  return {};
}

/// An exchange of a chain: the relays that replace its own, and whether they are prepared before.
struct ExchangeKind {
  Exchange which;
  std::string name;
  bool prepared = false;
};

/// One switch there and one back; both are exchanges of the same tasks.
Result<void> measure_exchange(BenchRobot& robot, const ChainOptions& target, const BenchSettings& settings,
                              const std::string& name, Rows& rows) {
  if (auto reset = robot.call("consumer", "reset"); !reset) return reset.error();
  if (auto runs = robot.wait_for_samples(); !runs) return runs;
  const auto done = robot.switch_to(relay_chain(target), order_of(settings));
  if (!done) return done.error();
  if (auto runs = robot.wait_for_samples(); !runs) return runs;
  const auto pause = robot.statistic("pause_max");
  if (!pause) return pause.error();
  rows.row("exchange " + name).seconds.push_back(done->seconds);
  rows.row("pause " + name).seconds.push_back(*pause);
  return {};
}

Result<void> measure_exchanges(BenchRobot& robot, ChainOptions chain, const ExchangeKind& kind,
                               const BenchSettings& settings, const BenchReport& report, Rows& rows) {
  if (kind.prepared) {
    ChainOptions other = chain;
    other.exchange = kind.which;
    if (auto ready = robot.prepare(relay_chain(chain), relay_chain(other)); !ready) return ready;
  }
  for (std::size_t i = 0; i < settings.repetitions && !report.stopped(); ++i) {
    show(report, chain, "exchange of " + kind.name, i);
    chain.exchange = i % 2 == 0 ? kind.which : Exchange::None;
    if (auto done = measure_exchange(robot, chain, settings, kind.name, rows); !done) return done;
  }
  if (kind.prepared) robot.drop_prepared();
  chain.exchange = Exchange::None;
  if (auto back = robot.switch_to(relay_chain(chain)); !back) return back.error();
  return {};
}

Result<void> measure_restarts(BenchRobot& robot, ChainOptions chain, const BenchSettings& settings,
                              const BenchReport& report, Rows& rows) {
  for (std::size_t i = 0; i < settings.repetitions && !report.stopped(); ++i) {
    show(report, chain, "restart", i);
    chain.exchange = i % 2 == 0 ? Exchange::SecondHalf : Exchange::None;
    const auto down = robot.switch_to({}, order_of(settings));
    if (!down) return down.error();
    const auto up = robot.switch_to(relay_chain(chain), order_of(settings));
    if (!up) return up.error();
    rows.row("restart").seconds.push_back(down->seconds + up->seconds);
  }
  return {};
}

/// In one process nothing is deployed, which is the best case; the worst is on another computer.
std::string published_exchange(const ChainOptions& chain) {
  if (chain.relays > 50 || chain.transport == BenchTransport::SharedMemory) return {};
  return chain.transport == BenchTransport::Local ? "<= 320 ms" : "< 2 s";
}

Result<void> measure_half(BenchRobot& robot, const ChainOptions& chain, const BenchSettings& settings,
                          const BenchReport& report) {
  const std::array kinds = {ExchangeKind{Exchange::SecondHalf, "of the second half"},
                            ExchangeKind{Exchange::SecondHalf, "of the second half, prepared", true},
                            ExchangeKind{Exchange::EverySecond, "of every second"},
                            ExchangeKind{Exchange::EverySecond, "of every second, prepared", true}};
  Rows rows(chain);
  if (auto up = robot.switch_to(relay_chain(chain)); !up) return up.error();
  for (const ExchangeKind& kind : kinds) {
    if (auto done = measure_exchanges(robot, chain, kind, settings, report, rows); !done) return done;
  }
  rows.row("exchange of the second half").published = published_exchange(chain);
  if (auto done = measure_restarts(robot, chain, settings, report, rows); !done) return done;
  rows.add_to(report);
  return {};
}

}  // namespace

void run_bring_up(const BenchSettings& settings, const BenchReport& report) {
  for_each_chain(
      settings, report,
      [&](BenchTransport transport) { return chains_of(settings, transport, kPaperLengths); },
      [&](BenchRobot& robot, const ChainOptions& chain) {
        return measure_bring_up(robot, chain, settings, report);
      });
}

void run_exchange(const BenchSettings& settings, const BenchReport& report) {
  const auto chains = [&](BenchTransport transport) {
    auto all = chains_of(settings, transport, {10, 25, 50});
    for (ChainOptions& chain : all)
      chain.placement = ChainPlacement::Relays;
    return all;
  };
  for_each_chain(settings, report, chains, [&](BenchRobot& robot, const ChainOptions& chain) {
    return measure_half(robot, chain, settings, report);
  });
}

}  // namespace segue::cli
