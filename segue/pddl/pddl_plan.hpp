// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/pddl/pddl_text.hpp>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::pddl::detail {

/// A step of a plan: a list of an action and its objects, and what the plan says of its time, in seconds.
struct PddlStep {
  PddlTerm action;
  std::optional<double> begin;
  std::optional<double> duration;
};

/// The steps of a plan in the order in which they begin, or without times in that of the file. Reads what
/// planners write: "(move a b)", "0: (move a b) [1]", the steps in the output of FF ("step 0: MOVE A B"),
/// Madagascar ("STEP 0: move(a,b) move(c,d)"), and unified-planning
/// ("move(a, b)"). Anything else is one error that names the first line that is not a step.
std::optional<std::vector<PddlStep>> parse_plan(std::string_view text, const std::string& file,
                                                Diagnostics& diagnostics);

}  // namespace segue::pddl::detail
