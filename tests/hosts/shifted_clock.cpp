// SPDX-License-Identifier: Apache-2.0
// Preloaded into the processes of a host in a test: their wall clock differs from the computer's by what a
// file says (SEGUE_TEST_CLOCK: nanoseconds, as an int64), at each moment. Whoever waits until a time on the
// wall clock wakes up when that clock gets there, as with a real one. Clocks that never jump are not touched.
#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <ctime>

namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kLook = 10'000'000;  // how often a wait looks whether the clock has jumped

const std::int64_t* map_shift() {
  static const std::int64_t none = 0;
  const char* path = std::getenv("SEGUE_TEST_CLOCK");
  const int file = path == nullptr ? -1 : ::open(path, O_RDONLY | O_CLOEXEC);
  if (file < 0) return &none;
  void* memory = ::mmap(nullptr, sizeof(std::int64_t), PROT_READ, MAP_SHARED, file, 0);
  ::close(file);
  return memory == MAP_FAILED ? &none : static_cast<const std::int64_t*>(memory);
}

std::int64_t now(clockid_t clock) {
  timespec time{};
  ::syscall(SYS_clock_gettime, clock, &time);
  const std::int64_t real = time.tv_sec * kSecond + time.tv_nsec;
  if (clock != CLOCK_REALTIME && clock != CLOCK_REALTIME_COARSE) return real;
  static const std::int64_t* const shift = map_shift();
  return real + __atomic_load_n(shift, __ATOMIC_RELAXED);
}

timespec to_timespec(std::int64_t time) {
  return {time / kSecond, time % kSecond};
}

}  // namespace

extern "C" {

int clock_gettime(clockid_t clock, timespec* time) noexcept {
  if (clock != CLOCK_REALTIME && clock != CLOCK_REALTIME_COARSE) {
    return static_cast<int>(::syscall(SYS_clock_gettime, clock, time));
  }
  *time = to_timespec(now(clock));
  return 0;
}

int gettimeofday(timeval* time, void*) noexcept {
  const timespec exact = to_timespec(now(CLOCK_REALTIME));
  *time = {exact.tv_sec, exact.tv_nsec / 1000};
  return 0;
}

time_t time(time_t* to) noexcept {
  const time_t seconds = now(CLOCK_REALTIME) / kSecond;
  if (to != nullptr) *to = seconds;
  return seconds;
}

int pthread_cond_timedwait(pthread_cond_t* condition, pthread_mutex_t* mutex, const timespec* until) {
  const std::int64_t end = until->tv_sec * kSecond + until->tv_nsec;
  // A condition may have another clock, whose times are far smaller.
  const clockid_t clock = until->tv_sec < 1'000'000'000 ? CLOCK_MONOTONIC : CLOCK_REALTIME;
  for (;;) {
    const std::int64_t left = end - now(clock);
    if (left <= 0) return ETIMEDOUT;
    const timespec look = to_timespec(now(CLOCK_MONOTONIC) + std::min(left, kLook));
    const int result = ::pthread_cond_clockwait(condition, mutex, CLOCK_MONOTONIC, &look);
    if (result != ETIMEDOUT) return result;
  }
}
}
