// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <cstdint>

namespace segue::testing {

/// A domain of DDS, or of ROS 2, for this process. Programs that run at the same time rarely share one, and
/// it is none of the pages of the manual (70 to 89).
inline std::uint32_t dds_domain_of_process() {
  constexpr std::uint32_t kFirst = 90;
  constexpr std::uint32_t kCount = 140;  // up to 229: the ports of larger ones than 232 do not exist
  return kFirst + static_cast<std::uint32_t>(::getpid()) % kCount;
}

}  // namespace segue::testing
