// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/action_runner.hpp>
#include <segue/mission/history.hpp>
#include <segue/mission/world.hpp>

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace segue::mission::detail {

struct Activation;

/// A value that states of a container exchange, and when it was written (0: never).
struct Slot {
  type::Value value;
  std::uint64_t stamp = 0;
};

/// What a step back needs to know of a child that has ended.
struct Trail {
  std::uint32_t position = 0;
  std::uint32_t item = History::kNone;
  std::vector<type::Value> inputs{};                     ///< of a leaf
  World::Changes changed{};                              ///< likewise
  bool refused = false;                                  ///< likewise
  std::vector<std::pair<std::uint32_t, Slot>> before{};  ///< what its end replaced
  Outcome last = 0;                                      ///< of the container, before it
  std::string error{};
  Activation* kept = nullptr;  ///< a container's or library's activation with its own trail
};

/// One execution of a state. Belongs to the engine's pool; the generation tells one use from the next.
struct Activation {
  /// Done: ended, and waiting for its siblings.
  enum class Phase : std::uint8_t { Begin, Proceed, Wait, Finish, Done };

  StateIndex state = kNoState;
  Activation* parent = nullptr;
  Phase phase = Phase::Begin;
  bool preempted = false;
  bool held = false;
  bool pass = false;      ///< held, and let go for one child
  bool mark = false;      ///< where a step over or out ends
  bool deferred = false;  ///< a leaf under way that a Completer will end
  bool refused = false;   ///< a leaf whose action was not begun, for want of a fact
  bool recalled = false;  ///< a leaf whose end is that of an earlier run
  std::uint32_t iteration = 0;
  std::uint32_t item = History::kNone;
  std::uint64_t generation = 0;
  Outcome outcome = 0;
  std::string error;                ///< what it, or the last of its children, aborted with
  std::string error_before;         ///< leaves: of the state before
  std::vector<GroundFact> effects;  ///< leaves: if they end as expected
  World::Changes changed{};         ///< leaves: what came of that
  std::vector<type::Value> inputs;
  std::vector<type::Value> outputs;
  std::function<void()> preempt;  ///< leaves under way
  Ending timed;                   ///< how it ends when its time is over

  std::vector<Slot> slots;  ///< containers, from here on
  Step pending;             ///< Hierarchy: what comes next
  Outcome last = 0;         ///< of the child before
  std::vector<Activation*> children;
  std::uint32_t open = 0;       ///< concurrency: children that have not ended
  Activation* first = nullptr;  ///< Preemptive: who ended first
  std::vector<BranchResult> branches;
  std::vector<Trail> trail;
};

}  // namespace segue::mission::detail
