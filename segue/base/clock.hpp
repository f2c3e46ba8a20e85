// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace segue {

using Duration = std::chrono::nanoseconds;
/// Monotonic time (CLOCK_MONOTONIC); for VirtualClock the epoch is 0.
using TimePoint = std::chrono::time_point<std::chrono::steady_clock, Duration>;

/// Where time comes from, so that tests need not wait. All functions may be called from any thread.
class Clock {
 public:
  virtual ~Clock() = default;
  [[nodiscard]] virtual TimePoint now() const = 0;
  /// Blocks the calling thread until `when`; returns at once if it has passed.
  virtual void sleep_until(TimePoint when) = 0;
};

/// The machine's monotonic clock.
class RealClock final : public Clock {
 public:
  [[nodiscard]] TimePoint now() const override { return std::chrono::steady_clock::now(); }
  void sleep_until(TimePoint when) override;
  /// One for all.
  static RealClock& instance();
};

/// Time that moves only when it is told to.
class VirtualClock final : public Clock {
 public:
  [[nodiscard]] TimePoint now() const override;
  void sleep_until(TimePoint when) override;
  /// Moves time forward and wakes whoever waits for it.
  void advance(Duration step);

 private:
  mutable std::mutex mutex_;
  std::condition_variable moved_;
  TimePoint now_{};
};

}  // namespace segue
