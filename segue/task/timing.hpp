// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/task/duration_histogram.hpp>

#include <cstdint>

namespace segue::task {

/// Timing of a task's updates since its last start. Durations are wall-clock.
struct Timing {
  std::uint64_t cycles = 0;
  std::uint64_t missed = 0;  ///< periodic: times that passed without an update
  Duration last{0};          ///< of the last update
  Duration mean{0};
  Duration worst{0};
  Duration latency_mean{0};  ///< from due time (periodic) or trigger (others) to the start of the update
  Duration latency_worst{0};
  Duration jitter{0};  ///< mean absolute deviation of the time between updates from the period
  /// Processor time of all updates, estimated from their share of their thread's time, so that measuring is
  /// free.
  Duration cpu{0};
};

/// The updates of Timing one by one.
struct TimingHistograms {
  DurationHistogram updates;    ///< their durations
  DurationHistogram latencies;  ///< from due time or trigger to the start of each
  friend bool operator==(const TimingHistograms&, const TimingHistograms&) = default;
};

}  // namespace segue::task
