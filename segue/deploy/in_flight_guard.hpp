// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>

#include <condition_variable>
#include <cstddef>
#include <mutex>

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

  /// Lets nothing more begin, and waits for what is in flight; false where some of it still is at `deadline`.
  bool close(TimePoint deadline) {
    std::unique_lock lock(mutex_);
    closed_ = true;
    return left_.wait_until(lock, deadline, [&] { return inside_ == 0; });
  }

 private:
  bool enter() {
    const std::lock_guard lock(mutex_);
    if (!closed_) ++inside_;
    return !closed_;
  }
  void leave() {
    const std::lock_guard lock(mutex_);
    if (--inside_ == 0) left_.notify_all();
  }

  std::mutex mutex_;  ///< protects both below
  std::condition_variable left_;
  std::size_t inside_ = 0;
  bool closed_ = false;
};

}  // namespace segue::deploy::detail
