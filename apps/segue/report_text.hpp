// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include <cstddef>
#include <string>
#include <string_view>

#include "command.hpp"

/// Reports of a robot as text: transitions, their outcomes, and events.
namespace segue::cli {

/// The empty network where a name is expected, as for `segue switch` and `segue diff`.
inline constexpr std::string_view kEmptyNetwork = "empty";

/// "stop slam", from an action's JSON.
std::string action_label(const type::Value& action);

/// A transition as text, from the JSON of `diff`: a summary, the actions of each phase, the counts, and the
/// estimate where it has one.
std::string describe_transition(const type::Value& transition);

/// The changes of the network, as sentences; "" where the transition names none.
std::string changes_of(const type::Value& transition);

/// "explore -> manual: done, 12 actions in 3.1 ms (commit 1.2 ms)"
std::string outcome_line(const type::Value& result);

/// "; look-ahead saved 1.2 s (4 tasks were ready)"; "" where nothing was prepared.
std::string saving_of(const type::Value& result);
/// "Look-ahead saved 1.2 s of 3 transitions."
std::string saving_line(double seconds, std::size_t transitions);

/// The actions of a result with their times, and its outcome_line().
std::string outcome_text(const type::Value& result);

/// Prints "diagnostics", "error" and "leftover" of a result on standard error.
void print_reasons(const type::Value& result);

/// Prints the result of `switch` as JSON or text. Returns kDone if the outcome is done, otherwise kFailed.
int show_outcome(const type::Value& result, const Context& context);

/// One event as a line: number, time of day, kind, subject, message.
std::string event_line(const type::Value& event);

}  // namespace segue::cli
