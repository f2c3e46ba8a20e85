// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/task/duration_histogram.hpp>

#include <atomic>
#include <cstdint>

namespace segue::sample_link {

/// How long samples of a connection took from being written to being read, of those that were measured
/// (task::detail::SampleStamps); samples from before the connection are not among them.
struct Latency {
  std::uint64_t measured = 0;
  Duration mean{0};
  Duration worst{0};
  Duration p99{0};  ///< 99 of 100 took no longer; rounded up to the end of a bin (task::DurationHistogram)
  friend bool operator==(const Latency&, const Latency&) = default;
};

/// The latency of samples that pass through both, one after the other. The worst and the 99th percentile are
/// bounds: they may have been those of two samples.
Latency in_series(const Latency& first, const Latency& second);

/// Collects a Latency: the reader adds, any thread reads. All is relaxed with one writer, so the figures of
/// one reading may be one sample apart.
class LatencyRecorder {
 public:
  /// Samples that were written before do not count. Any thread.
  void begin_at(TimePoint time) noexcept {
    since_.store(time.time_since_epoch().count(), std::memory_order_relaxed);
  }
  /// A sample was read. TimePoint(): it is not to be measured. A time that cannot be does not count, since it
  /// may come from another process. The reader only; real-time safe.
  void add(TimePoint written_at) noexcept {
    if (written_at != TimePoint()) add(written_at, monotonic_now());
  }
  /// Records a sample that was read at `now`. The reader only; real-time safe.
  void add(TimePoint written_at, TimePoint now) noexcept;
  [[nodiscard]] Latency read() const noexcept;

 private:
  std::atomic<std::int64_t> since_{0};
  std::atomic<std::uint64_t> measured_{0};
  std::atomic<std::uint64_t> total_{0};
  std::atomic<std::int64_t> worst_{0};
  task::detail::HistogramRecorder histogram_;
};

}  // namespace segue::sample_link
