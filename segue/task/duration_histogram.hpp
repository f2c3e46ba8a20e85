// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <numeric>

namespace segue::task {

/// How often durations fell into each of a fixed number of bins, of which two are as wide as the duration
/// doubles: [128 ns, 192 ns), [192 ns, 256 ns), [256 ns, 384 ns) and so on. The first one has all below
/// 128 ns, the last one all from 17.2 s on.
struct DurationHistogram {
  static constexpr std::size_t kBins = 56;
  std::array<std::uint64_t, kBins> counts{};

  /// In constant time, without a division. Negative durations count as 0.
  [[nodiscard]] static constexpr std::size_t bin_of(Duration duration) noexcept {
    const auto count = static_cast<std::uint64_t>(duration.count() > 0 ? duration.count() : 0);
    if (count < std::uint64_t{1} << kFirstOctave) return 0;
    const auto octave = static_cast<unsigned>(std::bit_width(count)) - 1;
    const std::size_t bin = 1 + 2 * (octave - kFirstOctave) + (count >> (octave - 1) & 1U);
    return bin < kBins ? bin : kBins - 1;
  }
  /// The least duration of a bin.
  [[nodiscard]] static constexpr Duration from(std::size_t bin) noexcept {
    if (bin == 0) return Duration(0);
    const std::int64_t octave = std::int64_t{1} << (kFirstOctave + (bin - 1) / 2);
    return Duration((bin - 1) % 2 == 0 ? octave : octave + octave / 2);
  }
  /// The upper bound of a bin: all its durations are shorter. Duration::max() of the last one.
  [[nodiscard]] static constexpr Duration below(std::size_t bin) noexcept {
    return bin + 1 < kBins ? from(bin + 1) : Duration::max();
  }

  [[nodiscard]] std::uint64_t total() const {
    return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
  }
  /// The quantile of that share (0 to 1): the duration that this share of all durations does not exceed,
  /// rounded up to the end of a bin; 0 where there are none.
  [[nodiscard]] Duration quantile(double share) const;

  friend bool operator==(const DurationHistogram&, const DurationHistogram&) = default;

 private:
  static constexpr unsigned kFirstOctave = 7;
};

namespace detail {

/// Counts a DurationHistogram: one thread at a time adds, any thread reads. Relaxed, so a reading may miss
/// what is being added.
class HistogramRecorder {
 public:
  void reset() noexcept {
    for (auto& count : counts_)
      count.store(0, std::memory_order_relaxed);
  }
  /// Real-time safe.
  void add(Duration duration) noexcept {
    auto& count = counts_[DurationHistogram::bin_of(duration)];
    count.store(count.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  }
  [[nodiscard]] DurationHistogram read() const noexcept {
    DurationHistogram histogram;
    for (std::size_t bin = 0; bin < counts_.size(); ++bin)
      histogram.counts[bin] = counts_[bin].load(std::memory_order_relaxed);
    return histogram;
  }

 private:
  std::array<std::atomic<std::uint64_t>, DurationHistogram::kBins> counts_{};
};

}  // namespace detail

}  // namespace segue::task
