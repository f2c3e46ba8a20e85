// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/mission/action_runner.hpp>
#include <segue/mission/commanded_robot.hpp>

#include <map>
#include <optional>
#include <set>
#include <string>

#include "rover_mission.hpp"

namespace segue::testing {

/// Follows a run by what it reports, and finds irreversible actions that overlap although one changes a fact
/// or a value which the other one relies on or changes otherwise, both hold the same resource, or their
/// controllers cannot run at once. It knows what the mission declares, and nothing of the engine. Thread
/// safe.
class OverlapCheck {
 public:
  /// Both must outlive this.
  OverlapCheck(const RoverMission& mission, const mission::ControllerConflicts& conflicts)
      : mission_(mission), conflicts_(conflicts), facts_(mission.world) {}

  void note(const mission::StateEvent& event);
  /// The first forbidden overlap; nothing: there was none.
  [[nodiscard]] std::optional<std::string> problem() const;
  /// How many irreversible actions that hold a resource began while another one was under way.
  [[nodiscard]] int overlaps() const;
  /// How often an execution that had been discarded began again.
  [[nodiscard]] int repeated() const;

 private:
  void begin(const std::string& name, const Touches& touches) SEGUE_REQUIRES(mutex_);
  /// Why both must not overlap; empty: they may.
  [[nodiscard]] std::string conflict(const Touches& a, const Touches& b) const SEGUE_REQUIRES(mutex_);
  /// What `one` would change under the hands of `other`; empty: nothing.
  [[nodiscard]] std::string disturbance(const Touches& one, const Touches& other) const
      SEGUE_REQUIRES(mutex_);

  const RoverMission& mission_;
  const mission::ControllerConflicts& conflicts_;
  mutable Mutex mutex_;  ///< protects all below
  std::set<std::string> facts_ SEGUE_GUARDED_BY(mutex_);
  std::set<std::string> under_way_ SEGUE_GUARDED_BY(mutex_);
  std::set<std::string> may_be_discarded_ SEGUE_GUARDED_BY(mutex_);  ///< begun and not ended
  std::optional<std::string> problem_ SEGUE_GUARDED_BY(mutex_);
  int overlaps_ SEGUE_GUARDED_BY(mutex_) = 0;
  int repeated_ SEGUE_GUARDED_BY(mutex_) = 0;
};

}  // namespace segue::testing
