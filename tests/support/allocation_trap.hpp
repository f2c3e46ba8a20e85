// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>

/// Replaces malloc: every allocation of the program passes through here, and those of trapped threads are
/// counted. To be included in one source of a test program, which must not run under a sanitizer.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* memory);
}

namespace segue::testing {

inline thread_local bool trapped = false;
inline std::atomic<int> caught{0};

inline void note_allocation() {
  if (trapped) caught.fetch_add(1);
}

}  // namespace segue::testing

extern "C" {
void* malloc(std::size_t size) {
  segue::testing::note_allocation();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  segue::testing::note_allocation();
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) {
  segue::testing::note_allocation();
  return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  segue::testing::note_allocation();
  return __libc_memalign(alignment, size);
}
void free(void* memory) {
  if (memory != nullptr) segue::testing::note_allocation();
  __libc_free(memory);
}
}
