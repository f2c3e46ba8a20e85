// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/model/transition.hpp>

#include <functional>
#include <stop_token>
#include <utility>

namespace segue::task_host {

/// Has actions in progress left as they are, so that nobody waits for them. Thread safe.
class Leaving {
 public:
  /// Whether whoever waits may leave that action; called from any thread, must not block.
  using MayBeLeft = std::function<bool(const model::Action& action)>;

  /// Leaves those in progress, once or several times. Does not block.
  void leave(const MayBeLeft& may_be_left) {
    const Lock lock(mutex_);
    if (leave_) leave_(may_be_left);
  }

  /// Carries out what leave() asks for, as long as it lives; one at a time.
  class Handler {
   public:
    Handler(Leaving* leaving, std::function<void(const MayBeLeft&)> leave) : leaving_(leaving) {
      set(std::move(leave));
    }
    /// Waits for a call in progress.
    ~Handler() { set({}); }
    Handler(const Handler&) = delete;
    Handler& operator=(const Handler&) = delete;

   private:
    void set(std::function<void(const MayBeLeft&)> leave) {
      if (leaving_ == nullptr) return;
      const Lock lock(leaving_->mutex_);
      leaving_->leave_ = std::move(leave);
    }
    Leaving* leaving_;
  };

 private:
  Mutex mutex_;  ///< protects the next one, also while it is called
  std::function<void(const MayBeLeft&)> leave_ SEGUE_GUARDED_BY(mutex_);
};

/// How actions that are carried out in their order are ended before all are done.
struct EarlyEnd {
  std::stop_token stop{};      ///< nothing new begins any more
  Leaving* leaving = nullptr;  ///< may be null
  /// Called once for each that was left, when it has ended; from any thread, must not block. May be empty.
  std::function<void(const model::Action& action)> left_ended{};
};

}  // namespace segue::task_host
