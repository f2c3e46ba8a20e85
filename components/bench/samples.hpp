// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/describe.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace bench {

/// A sample of the producer: numbered, with a time stamp (monotonic clock, ns) and a payload of configurable
/// size.
struct Sample {
  std::uint64_t sequence = 0;
  std::int64_t stamp = 0;
  std::vector<std::uint8_t> payload;
};

/// A sample with a payload of fixed size, so that it is copied as bytes.
struct FixedSample {
  std::uint64_t sequence = 0;
  std::int64_t stamp = 0;
  std::array<std::uint8_t, 48> payload{};
};

/// Statistics of a consumer since it was started or reset. Latencies in seconds, from the producer's time
/// stamp to the consumer's update; lost counts sequence numbers that are missing, late those that came
/// after a newer one; pause_max is the longest time
/// between two arrivals, in seconds; last_arrival is the time of the last arrival (monotonic clock, ns).
struct Statistics {
  std::uint64_t count = 0;
  std::uint64_t lost = 0;
  std::uint64_t late = 0;
  double latency_min = 0;
  double latency_mean = 0;
  double latency_max = 0;
  double pause_max = 0;
  std::int64_t last_arrival = 0;
};

SEGUE_TYPE(Sample, sequence, stamp, payload)
SEGUE_TYPE(FixedSample, sequence, stamp, payload)
SEGUE_TYPE(Statistics, count, lost, late, latency_min, latency_mean, latency_max, pause_max, last_arrival)

}  // namespace bench
