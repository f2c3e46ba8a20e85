// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace segue::mission {

/// Outcomes as numbers: negative for those that every state has, from 0 for its own in declaration order.
using Outcome = std::int32_t;
inline constexpr Outcome kAborted = -1;
inline constexpr Outcome kPreempted = -2;

}  // namespace segue::mission
