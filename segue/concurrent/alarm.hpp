// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/descriptor.hpp>

#include <atomic>

namespace segue::concurrent {

/// Wakes one thread at a time that other threads set. A timer (timerfd) instead of a condition variable,
/// since setting it wakes nobody. One thread calls wait(); all other calls must exclude each other.
class Alarm {
 public:
  Alarm();

  /// False where the system had no timer left; it never goes off then.
  [[nodiscard]] bool works() const { return timer_.valid(); }
  /// Goes off at `when`, in place of what was set before; never for TimePoint::max().
  void set(TimePoint when);
  /// To be called after wait(): the time that was set may be set again.
  void gone_off() { when_ = TimePoint::max(); }
  /// When it goes off; TimePoint::max() where it is not set.
  [[nodiscard]] TimePoint when() const { return when_; }
  /// Blocks until it goes off; false after stop().
  bool wait();
  /// Ends wait(), now and for good.
  void stop();

 private:
  Descriptor timer_;
  TimePoint when_ = TimePoint::max();
  /// Set before a system call that rings the timer, read after the one that waits for it. These calls
  /// synchronise, so the order of the flag itself is of no importance.
  std::atomic<bool> stopped_{false};
};

}  // namespace segue::concurrent
