// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/transition.hpp>
#include <segue/type/value.hpp>

#include <string>

namespace segue::cli {

/// A transition as text: a summary, the actions of each phase, the counts.
std::string describe(const model::Transition& transition);

/// The same from the JSON of `diff`, as a running robot sends it.
std::string describe_transition(const type::Value& transition);

/// "stop slam" from an action's JSON.
std::string action_label(const type::Value& action);

}  // namespace segue::cli
