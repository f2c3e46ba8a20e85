// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace segue::task_network {

/// Faults that a test plants into the engine to prove that it would detect them. They exist only in the build
/// of that test, with SEGUE_CDTN_FAULTS; elsewhere `planted` is false at compile time.
enum class EngineFault : std::uint8_t {
  None,
  ForgetsFactOrder,      ///< every seventh node ignores the order that facts impose
  PassesAtStart,         ///< dependents of a node go on when it starts
  IgnoresConditions,     ///< irreversible nodes do not wait for conditions
  SkippedStillActs,      ///< a wrong branch is not stopped
  NeverValidates,        ///< results of pure nodes count even if predictions were wrong
  KeepsStaleInputs,      ///< results of pure nodes count even if their inputs have changed
  GrantsTwice,           ///< units in use are granted again
  ForgetsResourceOrder,  ///< irreversible nodes overtake each other at a resource
  ReturnsConsumed,       ///< consumed units come back
  GoesOnAfterFailure,    ///< nodes after a failed one still start
  StrictIsNot,           ///< strict mode does not wait for nodes that may fail
  AppliesEffectsTwice,   ///< effects of a discarded run are applied too
  LeavesGroupEarly,      ///< the first member that ends releases a group lock
  CommitsSpeculation,    ///< a speculative result counts at once
  NeverPreempts,         ///< speculative runs keep what earlier nodes need
  PreemptsWhatCounts,    ///< runs that are certain to count are preempted too
  KeepsPreemptedUnits,   ///< preempted runs do not release their units
  CountsPreempted        ///< the end of a run that was cancelled counts
};

#ifdef SEGUE_CDTN_FAULTS
/// The planted fault; set between runs.
inline EngineFault planted_fault = EngineFault::None;
inline bool planted(EngineFault fault) {
  return planted_fault == fault;
}
#else
constexpr bool planted(EngineFault) {
  return false;
}
#endif

}  // namespace segue::task_network
