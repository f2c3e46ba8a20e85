// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/action_times.hpp>
#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace segue::solve {

/// How an estimate is computed: equal options give equal results.
struct EstimateOptions {
  int trials = 200;  ///< fewer for transitions with very many actions
  std::uint64_t seed = 1;
};

/// Predicted durations of a transition. Nine of ten measured values should lie within their range.
struct Estimate {
  model::DurationRange total;  ///< from the begin of its execution to the end of its last action
  std::array<model::DurationRange, 3> phase;  ///< by model::Phase: from its first action's begin to its end
  /// Ids of the actions that typically decide the total, each waiting for the one before, in order.
  std::vector<int> critical_path;
  std::vector<Duration> typical;  ///< of each action, in the order of the list
  /// Number of actions without measured durations: estimated from actions of the same kind of other
  /// components.
  int never_measured = 0;

  [[nodiscard]] const model::DurationRange& of(model::Phase which) const {
    return phase.at(static_cast<std::size_t>(which));
  }
  friend bool operator==(const Estimate&, const Estimate&) = default;
};

/// Simulates the execution of a transition from `current` many times, with durations drawn from `times`.
/// Phases are sequential; within a phase all ready actions run concurrently, except quick actions of one
/// process, which are sequential. Pure: equal arguments give equal estimates.
Estimate estimate(const model::Network& current, const model::Transition& transition,
                  const model::ActionTimes& times, const EstimateOptions& options = {});

/// The typical duration of one phase of such a transition, where some durations of its actions are known: in
/// the order of the list, nothing where one is not. The others are those typical of `times`; actions that
/// were never measured take no time. Pure.
Duration typical_duration(const model::Network& current, const model::Transition& transition,
                          model::Phase phase, const model::ActionTimes& times,
                          const std::vector<std::optional<Duration>>& known);

}  // namespace segue::solve
