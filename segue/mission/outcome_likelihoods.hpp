// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/action.hpp>

#include <vector>

namespace segue::mission {

/// How likely the action ends with each of its outcomes, in their order, and at the end, where `may_abort`,
/// that it aborts; they add up to 1. What the action says counts. Of the rest, the outcome that it expects
/// gets four fifths, and the others share what is left; where none is expected, all get as much. That it
/// aborts takes one in twenty from the rest.
std::vector<double> outcome_likelihoods(const Action& action, bool may_abort);

}  // namespace segue::mission
