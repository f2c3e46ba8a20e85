// SPDX-License-Identifier: Apache-2.0
#include <segue/base/timed_mutex.hpp>

namespace segue {

bool TimedMutex::lock_until(TimePoint deadline) {
  const Lock lock(mutex_);
  const auto free = [this]() SEGUE_REQUIRES(mutex_) { return !written_ && readers_ == 0; };
  if (!changed_.wait_until(mutex_, deadline, free)) return false;
  written_ = true;
  return true;
}

void TimedMutex::unlock() {
  const Lock lock(mutex_);
  written_ = false;
  changed_.notify_all();
}

bool TimedMutex::lock_shared_until(TimePoint deadline) {
  const Lock lock(mutex_);
  if (!changed_.wait_until(mutex_, deadline, [this]() SEGUE_REQUIRES(mutex_) { return !written_; }))
    return false;
  ++readers_;
  return true;
}

void TimedMutex::unlock_shared() {
  const Lock lock(mutex_);
  if (--readers_ == 0) changed_.notify_all();
}

}  // namespace segue
