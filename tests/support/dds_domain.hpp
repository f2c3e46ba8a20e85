// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstdint>
#include <string>

namespace segue::testing {

/// A domain of DDS, or of ROS 2, that no other test program of this computer has as long as this one runs,
/// since tests count who is there. It is none of the pages of the manual (70 to 89), nor of tests in browsers
/// (20 to 69).
inline std::uint32_t dds_domain_of_process() {
  static const std::uint32_t domain = [] {
    constexpr std::uint32_t kFirst = 90;
    constexpr std::uint32_t kCount = 140;  // up to 229: the ports of larger ones than 232 do not exist
    const auto begin = static_cast<std::uint32_t>(::getpid());
    for (std::uint32_t i = 0; i < kCount; ++i) {
      const std::uint32_t one = kFirst + (begin + i) % kCount;
      const std::string file = "/tmp/segue-test-domain-" + std::to_string(one) + ".lock";
      const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
      // Locked until the end of the process.
      if (descriptor >= 0 && ::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return one;
      if (descriptor >= 0) ::close(descriptor);
    }
    return kFirst + begin % kCount;
  }();
  return domain;
}

}  // namespace segue::testing
