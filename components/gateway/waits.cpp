// SPDX-License-Identifier: Apache-2.0
// Cyclone DDS 0.10 waits for times of the wall clock. Were that set back, as by the first answer of a time
// server, its threads would sleep for that much longer, and send neither heartbeats nor signs of life. These
// functions take the place of those by which it waits, and use a clock that never jumps: its own calls reach
// the first definition in the order of the dynamic loader, which is that of the library or program that needs
// Cyclone.
#include <dds/dds.h>
#include <dds/ddsrt/sync.h>
#include <dds/version.h>

#if DDS_VERSION_MAJOR == 0

#include <pthread.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <ctime>

extern "C" {

[[gnu::visibility("default")]] bool ddsrt_cond_waitfor(ddsrt_cond_t* condition, ddsrt_mutex_t* mutex,
                                                       dds_duration_t duration) {
  timespec until{};
  ::clock_gettime(CLOCK_MONOTONIC, &until);
  const std::int64_t now = until.tv_sec * DDS_NSECS_IN_SEC + until.tv_nsec;
  if (duration > DDS_INFINITY - now) {
    ::ddsrt_cond_wait(condition, mutex);
    return true;
  }
  const std::int64_t end = now + std::max<dds_duration_t>(duration, 0);
  until = {end / DDS_NSECS_IN_SEC, end % DDS_NSECS_IN_SEC};
  return ::pthread_cond_clockwait(&condition->cond, &mutex->mutex, CLOCK_MONOTONIC, &until) != ETIMEDOUT;
}

[[gnu::visibility("default")]] bool ddsrt_cond_waituntil(ddsrt_cond_t* condition, ddsrt_mutex_t* mutex,
                                                         dds_time_t time) {
  return ::ddsrt_cond_waitfor(condition, mutex, time == DDS_NEVER ? DDS_INFINITY : time - ::dds_time());
}

}  // extern "C"

#endif
