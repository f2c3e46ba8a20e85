// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <ctime>
#include <string>

namespace segue {

using Duration = std::chrono::nanoseconds;
/// Monotonic time (CLOCK_MONOTONIC); the epoch of a VirtualClock is 0.
using TimePoint = std::chrono::time_point<std::chrono::steady_clock, Duration>;

/// The time of the RealClock. Any thread; real-time safe. Asks the system directly: what is called many times
/// from sleeping threads pays for each library on the way.
[[nodiscard]] inline TimePoint monotonic_now() noexcept {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return TimePoint(std::chrono::seconds(now.tv_sec) + Duration(now.tv_nsec));
}

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
  [[nodiscard]] TimePoint now() const override { return monotonic_now(); }
  void sleep_until(TimePoint when) override;
  /// The instance that everybody uses.
  static RealClock& instance();
};

/// The end of a wait in real time: a duration from now on, `task.configure(10s)`, or a time that several
/// waits share.
class Deadline {
 public:
  Deadline(TimePoint time) : time_(time) {}  // NOLINT(google-explicit-constructor)
  template <class Rep, class Period>
  Deadline(std::chrono::duration<Rep, Period> within)  // NOLINT(google-explicit-constructor)
      : time_(after(within)) {}
  operator TimePoint() const { return time_; }  // NOLINT(google-explicit-constructor)

 private:
  /// Duration::max() is a wait without an end.
  static TimePoint after(Duration within) {
    const TimePoint now = monotonic_now();
    return within < TimePoint::max() - now ? now + within : TimePoint::max();
  }
  TimePoint time_;
};

/// "2026-11-22T01:02:03.456Z": ISO 8601, UTC.
std::string iso_time(std::chrono::system_clock::time_point time);

}  // namespace segue
