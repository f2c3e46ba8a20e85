// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/transition.hpp>
#include <segue/solve/estimate.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace segue::runtime {

/// The most changes that a PlannedSwitch names.
inline constexpr std::size_t kMostPlannedChanges = 200;

/// All that is known of a switch before anything happens.
struct PlannedSwitch {
  model::Transition transition;
  /// model::changes() from the controller that runs to the requested one.
  std::vector<std::string> changes;
  /// By the durations in the journal; nothing where there are none.
  std::optional<solve::Estimate> expected;
};

}  // namespace segue::runtime
