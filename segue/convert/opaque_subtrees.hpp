// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/program.hpp>

#include <cstdint>
#include <string>
#include <vector>

/// Which states of a mission a concurrent run executes sequentially, as one node each.
namespace segue::convert {

/// Why a state is an opaque subtree.
struct OpaqueSubtreeReason {
  enum class Kind : std::uint8_t {
    None,
    Routine,            ///< it is declared so
    UsesUnfinished,     ///< a preemptive container whose outputs come from `state` in it, which has states
    HandlesPreemption,  ///< `state` in it has a transition for its preemption
    OpaqueBeside,       ///< a barrier or preemptive container, and `state` in it may touch anything
    DeclaresInRace,     ///< a preemptive container, and `state`, it or one in it, declares what it needs
    ReadsWorldBeside,  ///< a preemptive container, and `state`, it or one in it, reads the whole world, which
                       ///< others change
    ContradictedBeside,  ///< a barrier, and `state` in it takes away what one beside it needs, or reversely
    ConflictBeside  ///< what `state` in it touches decides which state of a preemptive container ends first
  };
  Kind kind = Kind::None;
  mission::StateIndex state = mission::kNoState;
};

/// Whether nothing is declared about what the action touches, so that it may touch anything.
[[nodiscard]] bool is_opaque(const mission::Action& action);

/// "since watch in it reads the whole world, which the states beside it change"; "" for None.
[[nodiscard]] std::string text_of(const OpaqueSubtreeReason& reason, const mission::Program& program);

/// The reasons of all states of the program, by state.
[[nodiscard]] std::vector<OpaqueSubtreeReason> find_opaque_subtrees(const mission::Program& program);

}  // namespace segue::convert
