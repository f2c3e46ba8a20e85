// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>

#include <condition_variable>
#include <cstddef>
#include <mutex>

namespace segue::deploy::detail {

/// Lets work through until it is closed. Thread safe.
class Gate {
 public:
  /// One piece of work, from its begin to its end; false where the gate was closed before.
  class Pass {
   public:
    explicit Pass(Gate& gate) : gate_(gate), inside_(gate.enter()) {}
    Pass(const Pass&) = delete;
    Pass& operator=(const Pass&) = delete;
    ~Pass() {
      if (inside_) gate_.leave();
    }
    explicit operator bool() const { return inside_; }

   private:
    Gate& gate_;
    const bool inside_;
  };

  /// Lets nothing more in, and waits for what is inside. False: some of it still is at `deadline`.
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

  std::mutex mutex_;
  std::condition_variable left_;
  std::size_t inside_ = 0;
  bool closed_ = false;
};

}  // namespace segue::deploy::detail
