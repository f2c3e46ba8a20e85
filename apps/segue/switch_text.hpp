// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include "command.hpp"

namespace segue::cli {

/// Prints the result of `switch` as JSON or text. Returns kDone if the outcome is done, otherwise kFailed.
int show_outcome(const type::Value& result, const Context& context);

/// "explore -> manual: done, 12 actions in 3.1 ms (commit 1.2 ms)"
std::string outcome_line(const type::Value& result);

}  // namespace segue::cli
