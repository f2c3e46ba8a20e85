// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace segue {

/// How much shared memory a process reserves. Here, not in `sample_link`, since whoever starts the process
/// states it without linking the real-time side.
struct SharedMemoryOptions {
  std::size_t prefault = std::size_t{1} << 20;  ///< bytes of the payload pool to prefault
  std::size_t payload = std::size_t{4} << 30;   ///< limit for samples; reserves address space, not memory
  std::size_t control = std::size_t{64} << 20;  ///< limit for rings of connections; reserves space only
};

}  // namespace segue
