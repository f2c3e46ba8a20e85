// SPDX-License-Identifier: Apache-2.0
#include "simulated_environment.hpp"

#include <segue/base/time_after.hpp>
#include <segue/base/varied_duration.hpp>

namespace segue::task_network {

Duration SimulatedEnvironment::duration(NodeId node, std::uint32_t attempt) const {
  return varied(network_[node].duration, seed_, std::uint64_t{index(node)}, attempt);
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
  const auto when = time_after(completions.now(), duration(node, context.attempt()));
  auto ending = report(node);
  if (!when) {
    ending = std::make_unique<Report>();
    ending->outcome = kAborted;
    ending->error = when.error().message;
  }
  completions.finish_at(when.value_or(completions.now()), node, context.attempt(), std::move(ending));
}

void SimulatedEnvironment::cancel(NodeId node, std::uint32_t attempt, Completions& completions) {
  auto report = std::make_unique<Report>();
  report->outcome = kPreempted;
  completions.finish_at(completions.now(), node, attempt, std::move(report));
}

}  // namespace segue::task_network
