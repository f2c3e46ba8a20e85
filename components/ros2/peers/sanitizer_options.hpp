// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <support/dds_suppressions.hpp>

/// Included once in each test program that loads Fast DDS.
#ifdef SEGUE_SANITIZER_ADDRESS
/// Fast DDS 2.9 deletes the listener of a best-effort writer as its base, whose destructor is virtual, with
/// the size of the base.
extern "C" [[gnu::used]] const char* __asan_default_options() {
  return "new_delete_type_mismatch=0";
}
#endif
#ifdef SEGUE_SANITIZER_THREAD
extern "C" [[gnu::used]] const char* __tsan_default_suppressions() {
  return segue::testing::kDdsSuppressions;
}
#endif
