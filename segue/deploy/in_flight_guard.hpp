// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>

#include <cstddef>

namespace segue::deploy::detail {

/// Counts work in flight, and lets none begin once it is closed. Thread safe.
class InFlightGuard {
 public:
  /// One piece of work, from its begin to its end; false where the guard was closed before.
  class Pass {
   public:
    explicit Pass(InFlightGuard& guard) : guard_(guard), inside_(guard.enter()) {}
    Pass(const Pass&) = delete;
    Pass& operator=(const Pass&) = delete;
    ~Pass() {
      if (inside_) guard_.leave();
    }
    explicit operator bool() const { return inside_; }

   private:
    InFlightGuard& guard_;
    const bool inside_;
  };

  /// Lets no work begin any more, and waits for the work in flight; false where some is left at `deadline`.
  bool close(TimePoint deadline) {
    Lock lock(mutex_);
    closed_ = true;
    return left_.wait_until(mutex_, deadline, [&]() SEGUE_REQUIRES(mutex_) { return inside_ == 0; });
  }

 private:
  bool enter() {
    const Lock lock(mutex_);
    if (!closed_) ++inside_;
    return !closed_;
  }
  void leave() {
    const Lock lock(mutex_);
    if (--inside_ == 0) left_.notify_all();
  }

  Mutex mutex_;  ///< protects both below
  ConditionVariable left_;
  std::size_t inside_ SEGUE_GUARDED_BY(mutex_) = 0;
  bool closed_ = false;
};

}  // namespace segue::deploy::detail
