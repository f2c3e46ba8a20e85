// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

/// Readers of what Linux tells in /proc (man 5 proc). They allocate nothing.
namespace computer {

/// Time that all processors together have spent, in ticks since the start of the computer.
struct ProcessorTicks {
  std::uint64_t idle = 0;  ///< waiting for a disk included
  std::uint64_t all = 0;
  std::uint32_t processors = 0;
};
/// Of the text of /proc/stat; nothing where that is not its text, or ends within the lines of processors.
std::optional<ProcessorTicks> processor_ticks(std::string_view stat);

struct MemoryBytes {
  std::uint64_t total = 0;
  std::uint64_t available = 0;
};
/// Of the text of /proc/meminfo; nothing where that lacks one of them.
std::optional<MemoryBytes> memory_bytes(std::string_view meminfo);

}  // namespace computer
