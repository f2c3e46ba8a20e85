// SPDX-License-Identifier: Apache-2.0
#include <segue/distributed/clock_reading.hpp>

namespace segue::distributed {

Result<ClockReading> read_clock(HostService& service) {
  const TimePoint begin = RealClock::instance().now();
  const auto before = std::chrono::system_clock::now();
  const auto there = service.clock();
  if (!there) {
    return there.error();
  }
  const Duration took = RealClock::instance().now() - begin;
  // The host read its clock half a round trip ago.
  return ClockReading{took, std::chrono::duration_cast<Duration>(*there - (before + took / 2))};
}

}  // namespace segue::distributed
