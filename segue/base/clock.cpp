// SPDX-License-Identifier: Apache-2.0
#include <segue/base/virtual_clock.hpp>

#include <array>
#include <ctime>
#include <thread>

namespace segue {

void RealClock::sleep_until(TimePoint when) {
  std::this_thread::sleep_until(when);
}

RealClock& RealClock::instance() {
  static auto* clock = new RealClock;  // never destroyed: a thread that hangs in a hook outlives main
  return *clock;
}

TimePoint VirtualClock::now() const {
  Lock lock(mutex_);
  return now_;
}

void VirtualClock::sleep_until(TimePoint when) {
  Lock lock(mutex_);
  moved_.wait(mutex_, [&]() SEGUE_REQUIRES(mutex_) { return now_ >= when; });
}

void VirtualClock::advance(Duration step) {
  {
    Lock lock(mutex_);
    now_ += step;
  }
  moved_.notify_all();
}

std::string iso_time(std::chrono::system_clock::time_point time) {
  const auto since_epoch = time.time_since_epoch();
  const auto whole = std::chrono::floor<std::chrono::seconds>(since_epoch);
  const auto millis = std::chrono::duration_cast<std::chrono::milliseconds>(since_epoch - whole).count();
  const std::time_t stamp = whole.count();
  std::tm parts{};
  gmtime_r(&stamp, &parts);
  std::array<char, 32> text{};
  const std::size_t length = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &parts);
  const std::string fraction = std::to_string(1000 + millis).substr(1);
  return std::string(text.data(), length) + '.' + fraction + 'Z';
}

}  // namespace segue
