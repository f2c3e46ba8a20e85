// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/mission/action_runner.hpp>
#include <segue/mission/enclosing_scope.hpp>
#include <segue/mission/units.hpp>
#include <segue/mission/world.hpp>
#include <segue/mission_engine/history.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace segue::mission::detail {

struct Activation;

/// A value that is passed between the states of a container, and when it was written (0: never).
struct Slot {
  type::Value value;
  std::uint64_t stamp = 0;
};

/// The units that a leaf has used, so that this can be undone. `done`: it ended as expected.
struct UnitsUsed {
  std::vector<UnitUse> uses{};
  bool done = false;
};

/// The data needed to step back over a child that has ended.
struct UndoRecord {
  std::uint32_t position = 0;
  std::uint32_t item = History::kNone;
  std::vector<type::Value> inputs{};                     ///< of a leaf
  World::Changes changed{};                              ///< of a leaf
  bool refused = false;                                  ///< of a leaf
  UnitsUsed units{};                                     ///< of a leaf
  std::vector<std::pair<std::uint32_t, Slot>> before{};  ///< the values that its end replaced
  Outcome last = 0;                                      ///< `last` of the container before it
  std::string error{};
  Activation* kept = nullptr;  ///< activation of a container or library, with its own records
};

/// One execution of a state. Belongs to the engine's pool and is reused; the generation distinguishes uses.
struct Activation {
  /// Done: it has ended and waits for its siblings.
  enum class Phase : std::uint8_t { Begin, Proceed, Wait, Finish, Done };

  StateIndex state = kNoState;
  Activation* parent = nullptr;
  Phase phase = Phase::Begin;
  bool preempted = false;
  bool held = false;
  bool pass = false;          ///< was held and is released for one child
  bool mark = false;          ///< a step over or out ends here
  bool deferred = false;      ///< a leaf that a completer will end
  bool refused = false;       ///< it did not begin: a precondition is not met, or units lack
  bool asks = false;          ///< a leaf or container that waits for units
  bool replayed = false;      ///< a leaf whose end comes from the journal
  bool begins_again = false;  ///< a leaf whose end is not in the journal, when the run is resumed
  bool told = false;          ///< a container whose begin was reported, and not its end
  std::uint32_t iteration = 0;
  std::uint32_t item = History::kNone;
  std::uint64_t generation = 0;
  Outcome outcome = 0;
  std::string error;                ///< the error of this state, or of its last child
  std::string error_before;         ///< leaves: the error of the preceding state
  std::vector<GroundFact> effects;  ///< leaves: applied if they end as expected
  ObservedNeedsPtr observed;        ///< leaves: of its facts
  World::Changes changed{};         ///< leaves: the changes this made
  std::vector<UnitUse> asked;       ///< units that it needs
  UnitsUsed units;                  ///< those that it has taken
  History::UnitWait unit_wait;      ///< while it waits for units that the robot does not show
  EnclosingScopePtr around;         ///< what is declared around it
  EnclosingScopePtr inside;         ///< containers: what is declared around its children
  std::vector<type::Value> inputs;
  std::vector<type::Value> outputs;
  StateIndex shown_as =
      kNoState;  ///< whose output defaults count: the outermost library that this is the root of
  std::function<void()> preempt;  ///< leaves that a completer will end
  Ending timed;                   ///< how it ends when its timer expires

  std::vector<Slot> slots;  ///< containers, from here on
  NextStep pending;         ///< Hierarchy: the next step
  Outcome last = 0;         ///< outcome of the preceding child
  std::vector<Activation*> children;
  std::uint32_t open = 0;       ///< concurrency: children that have not ended
  Activation* first = nullptr;  ///< Preemptive: the child that ended first
  std::vector<BranchResult> branches;
  std::vector<UndoRecord> undo;
};

/// The time when a leaf ends by itself, or by which it must have ended; the first one is the largest.
struct Timer {
  TimePoint when;
  std::uint64_t order = 0;
  Activation* activation = nullptr;
  std::uint64_t generation = 0;
  bool operator<(const Timer& other) const {
    return when == other.when ? order > other.order : when > other.when;
  }
};

/// The units that a robot shows, as far as an engine knows.
struct RobotUnits {
  std::shared_ptr<void> watched;  ///< null: nobody looks at them
  bool are_known = false;         ///< they have been looked at
  std::string lost;               ///< why the robot is lost for the mission; empty: it is not
};

/// The place where a hierarchy goes on once its child has been preempted.
struct Jump {
  Activation* at = nullptr;
  std::uint64_t generation = 0;
  std::vector<StateIndex> path;  ///< the next state last
};

}  // namespace segue::mission::detail
