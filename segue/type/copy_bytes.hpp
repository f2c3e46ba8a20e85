// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace segue::type::detail {

/// memcpy() for objects that may be large. glibc copies 2 KiB and more by `rep movsb`, which some processors
/// (AMD's Zen 3 to 5) do ten times as slowly where the destination lies a few bytes behind the source, modulo
/// 4 KiB (glibc's bug 30994): just where a vector begins, and its contents in the flat layout. Such bytes are
/// copied in smaller parts.
inline void copy_bytes(void* to, const void* from, std::size_t size) noexcept {
  constexpr std::size_t kPage = 4096;
  constexpr std::size_t kClose = 16;
  constexpr std::size_t kPart = 2048;
  const auto behind = (reinterpret_cast<std::uintptr_t>(to) - reinterpret_cast<std::uintptr_t>(from)) % kPage;
  if (size < kPage || behind == 0 || behind >= kClose) {
    if (size > 0) std::memcpy(to, from, size);
    return;
  }
  auto* target = static_cast<std::byte*>(to);
  const auto* source = static_cast<const std::byte*>(from);
  while (size > 0) {
    const std::size_t part = std::min(size, kPart);
    std::memcpy(target, source, part);
    target += part;
    source += part;
    size -= part;
  }
}

}  // namespace segue::type::detail
