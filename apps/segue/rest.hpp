// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include <string>

/// How a robot came to rest (control::RobotService::give_back, stop), for people.
namespace segue::cli {

bool is_at_rest(const type::Value& rest);
/// "stopped; the robot is at rest after 0.3 s"; or why it is not, and which tasks were stopped instead.
std::string rest_text(const std::string& what, const type::Value& rest);

}  // namespace segue::cli
