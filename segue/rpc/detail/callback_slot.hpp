// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>

#include <functional>
#include <utility>

namespace segue::control::detail {

/// The listener of a client, which may be replaced while events arrive. Thread safe.
template <class Event>
class CallbackSlot {
 public:
  using Listener = std::function<void(const Event&)>;

  /// No call of the previous listener is in progress when this returns.
  void set(Listener listener) {
    const Lock lock(mutex_);
    listener_ = std::move(listener);
  }
  void call(const Event& event) {
    const Lock lock(mutex_);
    if (listener_) listener_(event);
  }

 private:
  Mutex mutex_;  ///< protects the listener; held while it is called
  Listener listener_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::control::detail
