// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>

/// How much memory is allocated. The address sanitizer tells of every allocation; without a sanitizer those
/// by `new` count, which this header replaces, so one source of a program includes it.
namespace segue::fuzz {

/// By this thread; whoever wants to know sets it to 0 before.
inline thread_local std::size_t allocated = 0;

}  // namespace segue::fuzz

#ifdef SEGUE_SANITIZER_ADDRESS

// As in clang's <sanitizer/allocator_interface.h>; gcc has the function and not the header.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*allocated)(const volatile void*, std::size_t),
                                                         void (*freed)(const volatile void*));

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const auto count = [](const volatile void*, std::size_t size) { segue::fuzz::allocated += size; };
  const auto ignore = [](const volatile void*) {};
  return __sanitizer_install_malloc_and_free_hooks(count, ignore) > 0 ? 0 : 1;
}

#elif !defined(SEGUE_SANITIZER_THREAD)

// Not inlined, or gcc sees malloc and free of their own where new and delete belong together.
[[gnu::noinline]] void* operator new(std::size_t size) {
  segue::fuzz::allocated += size;
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
