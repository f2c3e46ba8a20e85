// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/pddl/pddl.hpp>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace segue::pddl {

/// A fact as a list of a predicate and its objects, and whether it holds.
struct ObservedAtom {
  std::vector<std::string> words;
  bool holds = true;
};

/// The problem with these facts in its initial state, in place of what it says of them. Comments and upper
/// case are lost. Nothing, and diagnostics, where it cannot be parsed or has no (:init ...).
std::optional<std::string> problem_with(const PddlText& problem, std::span<const ObservedAtom> facts,
                                        Diagnostics& diagnostics);

}  // namespace segue::pddl
