// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/distributed/host_service.hpp>

namespace segue::distributed {

/// How far away a host is, and how far its wall clock is ahead of this computer's.
struct ClockReading {
  Duration round_trip{0};
  Duration offset{0};  ///< give or take half a round trip, as in NTP
};

/// Reads the host's clock once. Blocks as HostService::clock() does; errors are its own.
Result<ClockReading> read_clock(HostService& service);

}  // namespace segue::distributed
