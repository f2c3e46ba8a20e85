// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>

#include <cstddef>

namespace segue::control::detail {

/// Counts what is in progress. Thread safe.
class Tally {
 public:
  void add() {
    const Lock lock(mutex_);
    ++count_;
  }
  void remove() {
    const Lock lock(mutex_);
    if (--count_ == 0) none_.notify_all();
  }
  void wait_for_none() {
    Lock lock(mutex_);
    none_.wait(mutex_, [this]() SEGUE_REQUIRES(mutex_) { return count_ == 0; });
  }

 private:
  Mutex mutex_;
  ConditionVariable none_;
  std::size_t count_ SEGUE_GUARDED_BY(mutex_) = 0;
};

}  // namespace segue::control::detail
