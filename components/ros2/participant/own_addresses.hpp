// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/mutex.hpp>

#include <array>
#include <cstdint>
#include <map>

namespace ros2 {

using Ipv4Address = std::array<std::uint8_t, 4>;

/// Whether an interface of this computer has the address, or it is one of loopback. Asks the system; any
/// thread.
bool is_own_address(const Ipv4Address& address);

/// Whether addresses are those of this computer, also of its interfaces to networks, which may change. Any
/// thread; asks the system at most once every ten seconds for each address.
class OwnAddresses {
 public:
  [[nodiscard]] bool contains(const Ipv4Address& address);

 private:
  struct Answer {
    bool is_own = false;
    segue::TimePoint asked_again{};
  };
  segue::Mutex mutex_;
  std::map<Ipv4Address, Answer> known_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace ros2
