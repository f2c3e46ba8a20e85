// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace segue::convert {

/// Faults that a test plants into the conversion to see that it would find them. They exist only in a build
/// with SEGUE_CONVERT_FAULTS, which nobody but that test makes; elsewhere `planted` is false at compile time.
enum class ConversionFault : std::uint8_t {
  None,
  ForgetsOldWrites,      ///< of several that may have written a value, only the last is asked
  TakesOldestWrite,      ///< the first of them counts
  KeepsNull,             ///< defaults do not stand for nulls
  ForgetsOuterDefaults,  ///< those of a library are not added to what it hands on
  SkipsCopies,           ///< what counts only under a condition counts always
  DecidesAsExpected,     ///< a branch counts as gone the expected way
  IgnoresInnerBranch,    ///< a node waits for the conditions around its own only
  MergesHalfBranches,    ///< two ways of a branch count as all
  JoinsAlways,           ///< a join says that one of its ways was taken
  NeverGoesBack,         ///< a loop that was expected to end is not taken up again
  ForgetsArrivals,       ///< of several ways to a state, one is lost
  ForgetsAbortedError,   ///< the state after an abort does not learn why
  ForgetsEffects,        ///< actions do not say what they change
  ForgetsResources,      ///< actions do not say what they use
  NothingIsOpaque,       ///< actions without facts and resources are taken to touch nothing
  CountsTwice,           ///< an execution of an action counts as two
  SwallowsExceptions,    ///< an action that throws succeeds
  AcceptsAnyOutcome,     ///< an outcome that an action does not have is its first
  CountsCancelled,       ///< an action that was cancelled ends as it likes
  MistakesBranches,      ///< a decider sees the states beside it as if all had ended like the first
  ForgetsSharedGlobals,  ///< opaque subtrees have global variables of their own
  Last = ForgetsSharedGlobals
};

#ifdef SEGUE_CONVERT_FAULTS
/// The one that is planted; set between runs.
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
