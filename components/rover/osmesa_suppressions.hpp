// SPDX-License-Identifier: Apache-2.0
#pragma once

/// For address sanitizer; to be included in one source of a test program. OSMesa does not free the buffers of
/// its contexts: some hundred bytes for each renderer.
#ifdef SEGUE_SANITIZER_ADDRESS
extern "C" [[gnu::used]] const char* __lsan_default_suppressions() {
  return "leak:libOSMesa.so\n";
}
#endif
