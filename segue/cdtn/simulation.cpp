// SPDX-License-Identifier: Apache-2.0
#include "simulation.hpp"

#include <cmath>

namespace segue::cdtn {

namespace {

/// splitmix64: a pseudo-random number from any number.
std::uint64_t mixed(std::uint64_t number) {
  number += 0x9E3779B97F4A7C15U;
  number = (number ^ (number >> 30)) * 0xBF58476D1CE4E5B9U;
  number = (number ^ (number >> 27)) * 0x94D049BB133111EBU;
  return number ^ (number >> 31);
}

}  // namespace

Duration SimulatedEnvironment::duration(NodeId node, std::uint32_t attempt) const {
  const Duration expected = network_[node].duration;
  if (seed_ == 0) return expected;
  const std::uint64_t number = mixed(mixed(mixed(seed_) ^ index(node)) ^ attempt);
  const double exponent = static_cast<double>(number >> 11) * 0x1p-53 * 2 - 1;
  return Duration(static_cast<Duration::rep>(static_cast<double>(expected.count()) * std::exp2(exponent)));
}

ReportPtr SimulatedEnvironment::report(NodeId node) const {
  if (index(node) >= trials_.size()) return nullptr;
  const Trial& trial = trials_[index(node)];
  if (trial.outcome == kSuccess && !trial.effects) return nullptr;
  auto report = std::make_unique<Report>();
  report->outcome = trial.outcome;
  report->effects = trial.effects;
  return report;
}

void SimulatedEnvironment::start(NodeContext& context, Completions& completions) {
  const NodeId node = context.node();
  completions.finish_at(completions.now() + duration(node, context.attempt()), node, context.attempt(),
                        report(node));
}

void SimulatedEnvironment::cancel(NodeId node, std::uint32_t attempt, Completions& completions) {
  auto report = std::make_unique<Report>();
  report->outcome = kPreempted;
  completions.finish_at(completions.now(), node, attempt, std::move(report));
}

}  // namespace segue::cdtn
