// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>

namespace segue::testing {

/// What a variable of the environment says, such as how often a test is repeated.
inline int number_from(const char* variable, int otherwise) {
  const char* text = std::getenv(variable);
  return text == nullptr ? otherwise : std::atoi(text);
}

}  // namespace segue::testing
