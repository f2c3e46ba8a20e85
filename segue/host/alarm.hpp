// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/descriptor.hpp>

#include <atomic>

namespace segue::host::detail {

/// Wakes a thread at a time that others set: setting it wakes nobody, which is why it is not a condition
/// variable. One thread waits; everything else from one thread at a time.
class Alarm {
 public:
  Alarm();

  /// False: the system had no resources for it. It never goes off then.
  [[nodiscard]] bool works() const { return timer_.valid(); }
  /// TimePoint::max(): not at all.
  void set(TimePoint when);
  /// What was set last has gone off, so the same may be set again.
  void gone_off() { when_ = TimePoint::max(); }
  /// Blocks until it has gone off once more; false after stop().
  bool wait();
  /// For good.
  void stop();

 private:
  Descriptor timer_;
  TimePoint when_ = TimePoint::max();
  std::atomic<bool> stopped_{false};
};

}  // namespace segue::host::detail
