// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/action_times.hpp>
#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace segue::solve {

struct EstimateOptions {
  int trials = 200;  ///< fewer where a transition has very many actions
  std::uint64_t seed = 1;
};

/// How long a transition will take. Nine of ten measured values should lie within their range.
struct Estimate {
  model::DurationRange total;  ///< from the begin of its execution to the end of its last action
  std::array<model::DurationRange, 3> phase;  ///< by model::Phase: from its first action's begin to its end
  /// Ids of the actions that typically decide the total, each waiting for the one before, in order.
  std::vector<int> critical_path;
  std::vector<Duration> typical;  ///< of each action, in the order of the list
  /// Actions whose like was never measured: guessed from the same kind of action of others.
  int never_measured = 0;

  [[nodiscard]] const model::DurationRange& of(model::Phase which) const {
    return phase.at(static_cast<std::size_t>(which));
  }
  friend bool operator==(const Estimate&, const Estimate&) = default;
};

/// Plays the execution of a transition from `current` many times, with durations drawn from `times`: phases
/// come one after the other; within a phase whatever is ready runs side by side, but for quick actions of one
/// process, which follow each other. Pure: the same arguments give the same estimate.
Estimate estimate(const model::Network& current, const model::Transition& transition,
                  const model::ActionTimes& times, const EstimateOptions& options = {});

}  // namespace segue::solve
