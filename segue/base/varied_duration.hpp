// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>

#include <cstdint>
#include <string_view>

namespace segue {

/// The duration of one simulated execution: between half and twice the expected one, the same for the same
/// three numbers. With seed 0 exactly as expected.
[[nodiscard]] Duration varied(Duration expected, std::uint64_t seed, std::uint64_t what, std::uint64_t turn);
/// The duration of one simulated execution of something that has a name, varied in the same way.
[[nodiscard]] Duration varied(Duration expected, std::uint64_t seed, std::string_view what,
                              std::uint64_t turn);

}  // namespace segue
