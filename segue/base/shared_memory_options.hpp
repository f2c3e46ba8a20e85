// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace segue {

/// How much shared memory a process reserves. Here rather than in `link`, since whoever starts the process
/// states it without linking the real-time side.
struct SharedMemoryOptions {
  std::size_t prefault = std::size_t{1} << 20;  ///< bytes of the payload pool made present at once
  std::size_t payload = std::size_t{4} << 30;   ///< the most that samples may take; address space, not memory
  std::size_t control = std::size_t{64} << 20;  ///< likewise for the rings of connections
};

}  // namespace segue
