// SPDX-License-Identifier: Apache-2.0
#include "calls.hpp"

namespace bench {

std::optional<Summary> omniorb_calls(Way, std::size_t) {
  return std::nullopt;
}

bool has_omniorb() {
  return false;
}

}  // namespace bench
