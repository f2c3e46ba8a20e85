// SPDX-License-Identifier: Apache-2.0
#include <segue/base/clock.hpp>

#include <thread>

namespace segue {

void RealClock::sleep_until(TimePoint when) {
  std::this_thread::sleep_until(when);
}

RealClock& RealClock::instance() {
  static RealClock clock;
  return clock;
}

TimePoint VirtualClock::now() const {
  std::scoped_lock lock(mutex_);
  return now_;
}

void VirtualClock::sleep_until(TimePoint when) {
  std::unique_lock lock(mutex_);
  moved_.wait(lock, [&] { return now_ >= when; });
}

void VirtualClock::advance(Duration step) {
  {
    std::scoped_lock lock(mutex_);
    now_ += step;
  }
  moved_.notify_all();
}

}  // namespace segue
