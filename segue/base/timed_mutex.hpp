// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>

#include <utility>

namespace segue {

/// Held by one writer, or by any number of readers; readers do not wait for a writer that waits itself, so a
/// thread may read more than once. Whoever wants it waits until a deadline at most. Clang does not follow who
/// holds it, since that may fail and the locks below may be moved. Made of Mutex, since the thread sanitizer
/// does not understand the waits of the standard's timed mutexes.
class TimedMutex {
 public:
  bool lock_until(TimePoint deadline);
  void unlock();
  bool lock_shared_until(TimePoint deadline);
  void unlock_shared();

 private:
  Mutex mutex_;
  ConditionVariable changed_;
  bool written_ SEGUE_GUARDED_BY(mutex_) = false;
  std::size_t readers_ SEGUE_GUARDED_BY(mutex_) = 0;
};

/// Holds a TimedMutex alone. False: it was not to be had until the deadline.
class TimedWriteLock {
 public:
  TimedWriteLock(TimedMutex& mutex, TimePoint deadline)
      : mutex_(mutex.lock_until(deadline) ? &mutex : nullptr) {}
  ~TimedWriteLock() {
    if (mutex_ != nullptr) mutex_->unlock();
  }
  TimedWriteLock(const TimedWriteLock&) = delete;
  TimedWriteLock& operator=(const TimedWriteLock&) = delete;
  explicit operator bool() const { return mutex_ != nullptr; }

 private:
  TimedMutex* mutex_;
};

/// Holds a TimedMutex beside others who read. False: it was not to be had until the deadline, or was moved
/// from.
class TimedReadLock {
 public:
  TimedReadLock() = default;
  TimedReadLock(TimedMutex& mutex, TimePoint deadline)
      : mutex_(mutex.lock_shared_until(deadline) ? &mutex : nullptr) {}
  ~TimedReadLock() {
    if (mutex_ != nullptr) mutex_->unlock_shared();
  }
  TimedReadLock(TimedReadLock&& other) noexcept : mutex_(std::exchange(other.mutex_, nullptr)) {}
  TimedReadLock& operator=(TimedReadLock&& other) noexcept {
    std::swap(mutex_, other.mutex_);
    return *this;
  }
  explicit operator bool() const { return mutex_ != nullptr; }

 private:
  TimedMutex* mutex_ = nullptr;
};

}  // namespace segue
