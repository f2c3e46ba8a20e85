// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>

/// Counts what is allocated by `new`, which this header replaces: one source of a program includes it.
/// Sanitizers want to own `new` themselves, so nothing is counted there, and SEGUE_COUNTS_NEW is not defined.
namespace segue::testing {

/// By this thread, as often and as much as whoever wants to know has not set it back.
inline thread_local std::size_t allocations = 0;
inline thread_local std::size_t allocated = 0;  ///< bytes

}  // namespace segue::testing

#if !defined(SEGUE_SANITIZER_ADDRESS) && !defined(SEGUE_SANITIZER_THREAD)
#define SEGUE_COUNTS_NEW

// Not inlined, or gcc sees malloc and free of their own where new and delete belong together.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++segue::testing::allocations;
  segue::testing::allocated += size;
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

#endif
