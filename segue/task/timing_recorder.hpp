// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/task/timing.hpp>

#include <atomic>
#include <cstdint>

namespace segue::task {

class Executor;

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
