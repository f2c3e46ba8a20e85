// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace segue::cli {

enum class Health : std::uint8_t {
  Good,
  Advice,  ///< robots run, but not as well as they could
  Bad      ///< something does not work
};
inline constexpr std::array<std::string_view, 3> kHealthNames = {"good", "advice", "bad"};

/// The result of one look at the computer.
struct Finding {
  std::string check;  ///< what was looked at: "real-time scheduling"
  Health health = Health::Good;
  std::string what{};
  std::string mend{};  ///< the command or the change that mends it; empty: nothing to mend
};

/// Looks at this computer and user: whether robots can run here as they should. Changes nothing. Takes less
/// than a second, but where a running robot does not answer.
std::vector<Finding> examine_computer();

}  // namespace segue::cli
