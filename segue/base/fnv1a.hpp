// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

namespace segue {

inline constexpr std::uint64_t kFnvBasis = 0xcbf29ce484222325U;

/// FNV-1a (Fowler, Noll and Vo) of 64 bits, continued from `before`: quick, and the same on every computer.
/// Tells texts apart that differ by accident, not those that somebody has made to have the same number.
constexpr std::uint64_t fnv1a(unsigned char byte, std::uint64_t before) {
  return (before ^ byte) * 0x100000001b3U;
}
constexpr std::uint64_t fnv1a(std::string_view text, std::uint64_t before = kFnvBasis) {
  for (const char c : text)
    before = fnv1a(static_cast<unsigned char>(c), before);
  return before;
}

}  // namespace segue
