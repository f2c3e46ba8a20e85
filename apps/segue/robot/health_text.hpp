// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include <string>

namespace segue::cli {

/// "healthy", "in_transition", "in_trouble" or "lost"; empty: the robot runs an older Segue.
std::string health_state(const type::Value& status);

/// The state of the runtime, or of the robot where something is wrong with it: a robot with broken parts is
/// not "idle".
std::string state_text(const type::Value& status);

/// The robot's troubles: each with its time, its reason and its repair.
std::string troubles_text(const type::Value& status);

}  // namespace segue::cli
