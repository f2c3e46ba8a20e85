// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <mutex>
#include <utility>

namespace segue::control::detail {

/// A client's listener. Thread safe.
template <class Event>
class Told {
 public:
  using Listener = std::function<void(const Event&)>;

  /// No call of the last one is under way when this returns.
  void set(Listener listener) {
    const std::lock_guard lock(mutex_);
    listener_ = std::move(listener);
  }
  void tell(const Event& event) {
    const std::lock_guard lock(mutex_);
    if (listener_) listener_(event);
  }

 private:
  std::mutex mutex_;
  Listener listener_;
};

}  // namespace segue::control::detail
