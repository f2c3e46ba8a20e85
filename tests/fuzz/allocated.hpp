// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../support/counted_new.hpp"

/// How much memory is allocated, in segue::testing::allocated: the address sanitizer tells of every
/// allocation; without a sanitizer those by `new` count. One source of a program includes it.
#ifdef SEGUE_SANITIZER_ADDRESS

// As in clang's <sanitizer/allocator_interface.h>; gcc has the function and not the header.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*allocated)(const volatile void*, std::size_t),
                                                         void (*freed)(const volatile void*));

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const auto count = [](const volatile void*, std::size_t size) { segue::testing::allocated += size; };
  const auto ignore = [](const volatile void*) {};
  return __sanitizer_install_malloc_and_free_hooks(count, ignore) > 0 ? 0 : 1;
}

#endif
