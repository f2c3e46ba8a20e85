// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/pddl/pddl.hpp>

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace segue::pddl {

/// A fact as a list of a predicate and its objects, and whether it holds.
struct GroundAtom {
  std::vector<std::string> words;
  bool holds = true;
};

/// The problem with these facts in its initial state, in place of what it says of them. Comments and upper
/// case are lost. Nothing, and diagnostics, where it cannot be parsed or has no (:init ...).
std::optional<std::string> problem_with(const PddlText& problem, std::span<const GroundAtom> facts,
                                        Diagnostics& diagnostics);

/// The facts that the first steps of a plan have changed, the earlier ones first.
std::vector<GroundAtom> effects_of(const PddlPlan& plan, std::size_t steps);

}  // namespace segue::pddl
