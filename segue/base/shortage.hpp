// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/text.hpp>

#include <cstdint>
#include <string>
#include <string_view>

namespace segue {

/// Why an action does not begin that needs more units of a resource than there can be, in all runs alike.
inline std::string shortage_text(std::string_view resource, std::uint64_t needed, std::uint64_t there) {
  return "it needs " + std::to_string(needed) + " of the resource " + quote(resource) + ", of which there " +
         (there == 1 ? "is " : "are ") + std::to_string(there);
}

}  // namespace segue
