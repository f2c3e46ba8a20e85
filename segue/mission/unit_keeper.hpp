// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/mission/execution.hpp>
#include <segue/mission/mission.hpp>
#include <segue/mission/units.hpp>

#include <functional>
#include <string>
#include <vector>

namespace segue::mission {

/// Called on the engine's thread for each execution that counts and has changed how many units there are,
/// once it has ended; also for one that a journal has, when it is replayed. Must not block.
using UnitObserver = std::function<void(const Execution& execution, const UnitChanges& changes)>;

/// The robot on which a mission runs, as far as it keeps the counts of units from one run to the next
/// (Resource::of_robot).
class UnitKeeper {
 public:
  virtual ~UnitKeeper() = default;
  UnitKeeper() = default;
  UnitKeeper(const UnitKeeper&) = delete;
  UnitKeeper& operator=(const UnitKeeper&) = delete;

  /// The counts at present. Blocks. Fails where the robot cannot be asked.
  virtual Result<UnitCounts> counts() = 0;
  /// A run begins, or goes on, that has begun with these counts; the changes that follow are its own.
  /// `journal`: the name of the run, by which a later one that goes on with it is recognised; empty: it has
  /// none. Blocks. NotFound for units that the robot does not keep; InvalidState where others have changed a
  /// count since the run began, or where the robot is not commanded by who asks.
  virtual Result<void> begin(const std::string& journal, const UnitCounts& counts) = 0;
  /// An execution of the run has changed these counts. Each execution of a run with a journal counts once,
  /// however often this is called. Thread safe; does not block.
  virtual void changed(const Execution& execution, const UnitChanges& changes) = 0;
};

/// The resources of which the robot keeps the counts.
[[nodiscard]] std::vector<std::string> robot_units(const Mission& mission);

/// The part of these changes that the robot must know. Units that are kept after an action are blocked, and
/// are still there.
[[nodiscard]] UnitChanges changes_of_robot_units(const Mission& mission, const UnitChanges& changes);

}  // namespace segue::mission
