// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/pddl/pddl_text.hpp>

#include <functional>
#include <limits>
#include <optional>

namespace segue::pddl::detail {

/// Conditions or effects of an action, as conjunctions "(and ...)" by their times.
struct PddlTimed {
  PddlTerm at_start;
  PddlTerm over_all;  ///< of conditions only
  PddlTerm at_end;
};

/// The parts of a durative action's condition: "(and (at start C) (over all C) (at end C))".
PddlTimed timed_condition(const PddlTerm& term, Diagnostics& diagnostics);
/// The parts of a durative action's effect, without effects on numbers.
PddlTimed timed_effect(const PddlTerm& term, Diagnostics& diagnostics);

/// How long an action may take, in seconds.
struct PddlDuration {
  double least = 0;
  double most = std::numeric_limits<double>::infinity();
};
/// The value of "(distance a ?b)"; nothing, and a diagnostic, where it has none.
using PddlValueOf = std::function<std::optional<double>(const PddlTerm& function)>;
/// Reads "(= ?duration E)", "(and (>= ?duration E) (<= ?duration E))" or "()", with numbers, functions,
/// '+', '-', '*' and '/' in E. Nothing, and a diagnostic, where there is anything else.
std::optional<PddlDuration> duration_of(const PddlTerm& constraint, const PddlValueOf& value_of,
                                        Diagnostics& diagnostics);

}  // namespace segue::pddl::detail
