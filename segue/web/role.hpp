// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

namespace segue::web {

/// What a browser may do: look, or change what the robot does, too.
enum class Role : std::uint8_t { Observe, Operate };

inline std::string_view to_string(Role role) {
  return role == Role::Observe ? "observe" : "operate";
}

}  // namespace segue::web
