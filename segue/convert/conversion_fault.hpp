// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace segue::convert {

/// Faults that a test plants into the conversion, to prove that the tests would find them. They exist only in
/// the build of that test (SEGUE_CONVERT_FAULTS); elsewhere `planted` is false at compile time.
enum class ConversionFault : std::uint8_t {
  None,
  ForgetsOldWrites,          ///< of several possible writers of a value, only the last is considered
  TakesOldestWrite,          ///< the first writer counts
  NullHidesOlder,            ///< a null hides what other writers have written before
  KeepsNull,                 ///< nulls are not replaced by defaults
  ForgetsOuterDefaults,      ///< the defaults of a library are ignored
  SkipsCopies,               ///< a value under a condition counts always
  DecidesAsExpected,         ///< a branch is assumed to end as expected
  IgnoresInnerBranch,        ///< a node waits for outer conditions only
  MergesHalfBranches,        ///< two edges of a branch count as all of them
  JoinsAlways,               ///< a join always says that a way was taken
  NeverGoesBack,             ///< a loop that was expected to end is not resumed
  StaysBehindBarrier,        ///< what was planned behind a barrier stays although a loop in it goes on
  ForgetsArrivals,           ///< of several ways to a state, one is lost
  ForgetsAbortedError,       ///< the state after an abort does not get the error
  ForgetsEffects,            ///< effects of actions are ignored
  ForgetsResources,          ///< resources of actions are ignored
  NothingIsOpaque,           ///< actions without facts and resources touch nothing
  CountsTwice,               ///< an execution of an action counts as two
  SwallowsExceptions,        ///< an action that throws succeeds
  AcceptsAnyOutcome,         ///< an undeclared outcome becomes the first one
  CountsCancelled,           ///< a cancelled action keeps its own outcome
  MistakesBranches,          ///< a decider sees the outcome of the first state for all
  ChangesGlobalsAtOnce,      ///< actions that may be discarded change global variables before they count
  ForgetsSharedGlobals,      ///< opaque subtrees have their own global variables
  ForgetsUnfinishedOutputs,  ///< a mission that fails has no outputs
  ResumesNothing,            ///< a resumed run executes everything again
  ForgetsRecord,             ///< the journal lacks facts of subtrees and global variables
  ForgetsLoops,              ///< the journal does not tell iterations of loops apart
  SeesOldWorld,              ///< actions see the world as it was at the beginning
  ForgetsChangesOfValues,    ///< actions act on values of the world that are not real yet
  ForgetsWorldData,          ///< what is attached to the world does not follow its facts
  ForgetsStrict,             ///< nothing is strict
  RacesConflict,             ///< states of a preemptive container that touch the same wait for each other
  NeedsContradicted,         ///< states of a barrier that take away what others need wait for each other
  RacesBeginEarly,           ///< states of a preemptive container begin before what comes before it has ended
  SeesOldUnits,              ///< opaque subtrees begin with the units of the beginning
  ForgetsEnclosingScope,     ///< what containers declare is ignored
  ForgetsMemory,             ///< executions begin with the persistent variables of an earlier one
  Last = ForgetsMemory
};

#ifdef SEGUE_CONVERT_FAULTS
/// The planted fault; set between runs.
inline ConversionFault planted_fault = ConversionFault::None;
inline bool planted(ConversionFault fault) {
  return planted_fault == fault;
}
#else
constexpr bool planted(ConversionFault) {
  return false;
}
#endif

}  // namespace segue::convert
