// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace segue::cdtn {

/// Faults that a test plants into the scheduler to see that it would find them. They exist only in a build
/// with SEGUE_CDTN_FAULTS, which nobody but that test makes; elsewhere `planted` is false at compile time.
enum class EngineFault : std::uint8_t {
  None,
  ForgetsFactOrder,      ///< every seventh node does not wait because of facts
  PassesAtStart,         ///< whoever waits for a node goes on when it starts
  IgnoresConditions,     ///< irreversible nodes do not wait for conditions
  SkippedStillActs,      ///< a wrong branch is not stopped
  NeverValidates,        ///< results of pure nodes count whatever they were based on
  KeepsStaleInputs,      ///< likewise, inputs only
  GrantsTwice,           ///< units in use are given away
  ForgetsResourceOrder,  ///< irreversible nodes overtake each other at a resource
  ReturnsConsumed,       ///< what was consumed comes back
  GoesOnAfterFailure,    ///< nodes after a failed one still start
  StrictIsNot,           ///< strict mode does not wait
  AppliesEffectsTwice,   ///< a repeated node's old effects are applied too
  LeavesGroupEarly,      ///< a group lock is given back by the first member that ends
  CommitsSpeculation,    ///< a speculative result counts at once
  NeverPreempts,         ///< who runs ahead keeps what nodes before it need
  PreemptsWhatCounts,    ///< runs that are certain to be wanted are recalled too
  KeepsPreemptedUnits,   ///< what is recalled is not given back
  CountsPreempted        ///< the end of a run that was cancelled counts
};

#ifdef SEGUE_CDTN_FAULTS
/// The one that is planted; set between runs.
inline EngineFault planted_fault = EngineFault::None;
inline bool planted(EngineFault fault) {
  return planted_fault == fault;
}
#else
constexpr bool planted(EngineFault) {
  return false;
}
#endif

}  // namespace segue::cdtn
