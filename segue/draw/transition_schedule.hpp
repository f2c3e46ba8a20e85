// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/model/transition.hpp>

#include <array>
#include <vector>

namespace segue::draw {

/// The times of all actions if phases follow each other and, within a phase, each action begins as soon as
/// its predecessors have ended.
struct Schedule {
  struct Span {
    double begin = 0;  ///< steps, or seconds
    double end = 0;
    [[nodiscard]] double length() const { return end - begin; }
  };
  std::vector<Span> actions;   ///< in the order of the list
  std::array<Span, 3> phases;  ///< by model::Phase
  std::vector<int>
      critical;           ///< places in the list: each begins when the one before ends; they decide the end
  bool measured = false;  ///< in seconds; else every action is one step

  [[nodiscard]] double length() const { return phases.back().end; }
};

/// `durations`: of each action, in the order of the list; empty: one step each.
Schedule schedule_of(const model::Transition& transition, const std::vector<Duration>& durations);

}  // namespace segue::draw
