// SPDX-License-Identifier: Apache-2.0
// E2.2: how long each kind of action takes.
#include <fmt/core.h>

#include <chrono>
#include <map>
#include <utility>

#include "bench_experiment.hpp"
#include "bench_floor.hpp"
#include "bench_rounds.hpp"

namespace segue::cli {

namespace {

using model::ActionKind;
using Durations = std::map<ActionKind, std::vector<double>>;

std::string published_action(ActionKind kind, BenchTransport transport) {
  switch (kind) {
    case ActionKind::Configure:
    case ActionKind::Deploy:
    case ActionKind::Undeploy:
      return "tens of ms";
    case ActionKind::Recover:
    case ActionKind::Start:
    case ActionKind::Stop:
    case ActionKind::Cleanup:
      return transport == BenchTransport::Remote ? "0.5 + 1.3 ms" : "0.5 ms";
    default:
      return {};
  }
}

/// The actions of one life of a chain: up, a call, an error, and down.
class ActionRun {
 public:
  ActionRun(BenchRobot& robot, const ChainOptions& chain, model::Order order)
      : robot_(robot), chain_(relay_chain(chain)), order_(order) {}

  Result<void> repeat() {
    if (auto up = note(robot_.switch_to(chain_, order_)); !up) return up;
    if (auto runs = robot_.wait_for_samples(); !runs) return runs;
    if (auto called = note(robot_.call_by_transition("consumer", "reset")); !called) return called;
    if (auto failed = robot_.make_fail("relay_1"); !failed) return failed;
    if (auto recovered = note(robot_.switch_to(chain_, order_)); !recovered) return recovered;
    return note(robot_.switch_to({}, order_));
  }

  [[nodiscard]] const Durations& durations() const { return durations_; }

 private:
  Result<void> note(const Result<Switched>& switched) {
    if (!switched) return switched.error();
    for (const runtime::ActionRecord& record : switched->actions) {
      if (!record.executed) continue;
      durations_[record.action.kind].push_back(std::chrono::duration<double>(record.duration).count());
    }
    return {};
  }

  BenchRobot& robot_;
  const model::Network chain_;
  const model::Order order_;
  Durations durations_;
};

/// Lower bounds of the times of actions in another process. Empty for actions in this process, and for those
/// on another computer, of which no bound is known.
struct ActionFloors {
  BenchFloor spawn;
  BenchFloor message;
};

Result<ActionFloors> measure_floors(const ChainOptions& chain, const BenchSettings& settings,
                                    const BenchReport& report) {
  const std::size_t repetitions = settings.repetitions;
  const bool elsewhere = chain.transport == BenchTransport::Remote && !settings.host.is_here();
  if (chain.transport == BenchTransport::Local || elsewhere) return ActionFloors{};
  auto spawn = floor_on_processors(
      [&](const Processors& processors) { return program_runs(1, repetitions, processors, report.stopped); });
  if (!spawn) return spawn.error();
  auto message = floor_on_processors([&](const Processors& processors) {
    return pipe_latencies(chain.transport, 1, 1, repetitions, processors, report.stopped);
  });
  if (!message) return message.error();
  return ActionFloors{std::move(*spawn), std::move(*message)};
}

Result<void> measure_round_trips(BenchRobot& robot, const ChainOptions& chain, const BenchSettings& settings,
                                 const BenchFloor& floor, const BenchReport& report) {
  auto seconds = robot.round_trips(settings.repetitions, report.stopped);
  if (!seconds) return seconds.error();
  if (!seconds->empty())
    report.add({"round trip", chain.transport, chain.relays, chain.bytes, std::move(*seconds), floor, {}});
  return {};
}

Result<void> measure_actions(BenchRobot& robot, const ChainOptions& chain, const BenchSettings& settings,
                             const BenchReport& report) {
  ActionRun run(robot, chain, settings.order.value_or(model::Order::Paper));
  for (std::size_t i = 0; i < settings.repetitions && !report.stopped(); ++i) {
    report.progress(fmt::format("{}: repetition {}", to_string(chain), i + 1));
    if (auto done = run.repeat(); !done) return done;
  }
  const auto floors = measure_floors(chain, settings, report);
  if (!floors) return floors.error();
  for (const auto& [kind, seconds] : run.durations()) {
    const bool spawns = kind == ActionKind::Deploy;
    const bool messages = !spawns && kind != ActionKind::Undeploy;
    report.add({std::string(to_string(kind)), chain.transport, chain.relays, chain.bytes, seconds,
                spawns     ? floors->spawn
                : messages ? floors->message
                           : BenchFloor{},
                published_action(kind, chain.transport)});
  }
  if (chain.transport == BenchTransport::Remote)
    return measure_round_trips(robot, chain, settings, floors->message, report);
  return {};
}

}  // namespace

void run_actions(const BenchSettings& settings, const BenchReport& report) {
  const auto chains = [&](BenchTransport transport) {
    auto all = chains_of(settings, transport, {1});
    for (ChainOptions& chain : all) {
      chain.placement = ChainPlacement::All;
      chain.ends = ChainEnds::OwnProcesses;
    }
    return all;
  };
  for_each_chain(settings, report, chains, [&](BenchRobot& robot, const ChainOptions& chain) {
    return measure_actions(robot, chain, settings, report);
  });
}

}  // namespace segue::cli
