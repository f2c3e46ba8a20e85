// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/halt.hpp>
#include <segue/model/ids.hpp>
#include <segue/model/robot.hpp>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

namespace segue::runtime {

/// A robot as its runtime knows it, besides its controllers.
struct RuntimeOptions {
  /// The controller to switch to if a failed transition cannot be undone; nothing: keep what then runs.
  std::optional<model::NetworkName> fallback;
  std::optional<model::Halt> halt{};  ///< what rest is; until load() or apply()
  model::Policies policies;           ///< for faults of the running controller
  model::LookAhead look_ahead;        ///< resource limits of standby controllers
  std::filesystem::path journal;      ///< the journal file (journal/journal.hpp); empty: none is kept
  /// Of the robot's files, canonical: durations are learned for it. Empty: it has none.
  std::filesystem::path robot_folder{};
  std::vector<model::Pool> pools{};       ///< run beside every controller
  model::PoolBudget pool_budget{};        ///< of their instances beyond the least numbers
  std::vector<model::UnitStock> units{};  ///< whose counts are kept beside the journal
  /// Of the results of requests that are kept, roughly; the newest is kept whatever it takes.
  std::size_t kept_bytes = std::size_t{32} << 20;
};

}  // namespace segue::runtime
