// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace segue::mission {

/// Position in Mission::states.
using StateIndex = std::uint32_t;
inline constexpr StateIndex kNoState = static_cast<StateIndex>(-1);

}  // namespace segue::mission
