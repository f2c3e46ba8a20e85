// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <functional>
#include <string>

#include "../command.hpp"
#include "../stop_signal.hpp"

namespace segue::cli {

/// Calls `request`, which waits for the outcome of a request of `who` (sender()), and shows its progress on a
/// terminal meanwhile. Ctrl-C, which `signal` has caught, cancels the request; a second one ends this
/// program, and the robot goes on. Null: nothing is cancelled.
Result<type::Value> follow_request(const std::string& who, StopSignal* signal, const Context& context,
                                   const std::function<Result<type::Value>()>& request);

}  // namespace segue::cli
