// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include <string>

namespace segue::cli {

/// "healthy", "in_transition", "in_trouble" or "lost"; empty: the robot runs an older Segue.
std::string health_state(const type::Value& status);

/// What the runtime does, unless something is wrong with the robot: nothing that is half dead is "idle".
std::string state_text(const type::Value& status);

/// What is missing, since when, why, and what repairs it.
std::string troubles_text(const type::Value& status);

}  // namespace segue::cli
