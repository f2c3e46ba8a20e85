// SPDX-License-Identifier: Apache-2.0
#include <segue/concurrent/alarm.hpp>

#include <sys/timerfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>

namespace segue::concurrent {

namespace {

/// A time of 0 would disarm the timer.
constexpr Duration kAtOnce = std::chrono::nanoseconds(1);

itimerspec spec_of(Duration since_boot) {
  itimerspec spec{};
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(since_boot);
  spec.it_value.tv_sec = seconds.count();
  spec.it_value.tv_nsec = (since_boot - seconds).count();
  return spec;
}

}  // namespace

Alarm::Alarm() : timer_(::timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC)) {}

void Alarm::set(TimePoint when) {
  if (when == when_ || !works() || stopped_) {
    return;
  }
  when_ = when;
  const auto spec =
      spec_of(when == TimePoint::max() ? Duration(0) : std::max(when.time_since_epoch(), kAtOnce));
  ::timerfd_settime(timer_.get(), TFD_TIMER_ABSTIME, &spec, nullptr);
}

bool Alarm::wait() {
  std::uint64_t count = 0;
  while (!stopped_ && ::read(timer_.get(), &count, sizeof count) < 0 && errno == EINTR) {
  }
  return !stopped_;
}

void Alarm::stop() {
  stopped_ = true;
  const auto spec = spec_of(kAtOnce);
  ::timerfd_settime(timer_.get(), TFD_TIMER_ABSTIME, &spec, nullptr);
}

}  // namespace segue::concurrent
