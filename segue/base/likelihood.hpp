// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace segue {

/// Whether the number can be a likelihood: between 0 and 1, both included. NaN cannot.
[[nodiscard]] constexpr bool is_likelihood(double number) {
  return number >= 0 && number <= 1;
}

}  // namespace segue
