// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/task/duration_histogram.hpp>
#include <segue/task/executor.hpp>

#include <atomic>
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

namespace detail {

/// Collects Timing: written by updates, one at a time, read by any thread. All counters are relaxed with one
/// writer, so the figures of one reading may be one update apart.
class TimingRecorder {
 public:
  void reset(const Executor& executor);
  void record(TimePoint due, TimePoint begin, TimePoint end, Duration period, std::uint64_t missed) noexcept;
  [[nodiscard]] Timing timing(const Executor& executor) const;
  [[nodiscard]] TimingHistograms histograms() const { return {updates_.read(), latencies_.read()}; }

 private:
  using Count = std::atomic<std::int64_t>;
  static void add(Count& count, std::int64_t value) noexcept {
    count.store(count.load(std::memory_order_relaxed) + value, std::memory_order_relaxed);
  }
  static void raise(Count& count, std::int64_t value) noexcept {
    if (value > count.load(std::memory_order_relaxed)) count.store(value, std::memory_order_relaxed);
  }

  Count cycles_{0};
  Count missed_{0};
  Count last_{0};
  Count total_{0};
  Count worst_{0};
  Count latency_total_{0};
  Count latency_worst_{0};
  Count deviation_total_{0};
  Count previous_begin_{0};
  Count cpu_at_start_{0};
  Count busy_at_start_{0};
  HistogramRecorder updates_;
  HistogramRecorder latencies_;
};

}  // namespace detail

}  // namespace segue::task
