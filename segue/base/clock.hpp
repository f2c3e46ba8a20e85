// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

namespace segue {

using Duration = std::chrono::nanoseconds;
/// Monotonic time (CLOCK_MONOTONIC); the epoch of a VirtualClock is 0.
using TimePoint = std::chrono::time_point<std::chrono::steady_clock, Duration>;

/// A source of time, so that tests need not wait. All functions may be called from any thread.
class Clock {
 public:
  virtual ~Clock() = default;
  [[nodiscard]] virtual TimePoint now() const = 0;
  /// Blocks the calling thread until `when`; returns at once if that has passed.
  virtual void sleep_until(TimePoint when) = 0;
};

/// The machine's monotonic clock.
class RealClock final : public Clock {
 public:
  [[nodiscard]] TimePoint now() const override { return std::chrono::steady_clock::now(); }
  void sleep_until(TimePoint when) override;
  /// The instance that everybody uses.
  static RealClock& instance();
};

/// The time of the RealClock.
[[nodiscard]] inline TimePoint monotonic_now() {
  return std::chrono::steady_clock::now();
}

/// "2026-11-22T01:02:03.456Z": ISO 8601, UTC.
std::string iso_time(std::chrono::system_clock::time_point time);

}  // namespace segue
