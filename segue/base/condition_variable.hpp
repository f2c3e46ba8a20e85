// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/mutex.hpp>

#include <condition_variable>
#include <stop_token>
#include <utility>

namespace segue {

/// std::condition_variable. Each wait gives back `mutex`, which is held, and has it again when it returns.
class ConditionVariable {
 public:
  void notify_one() noexcept { condition_.notify_one(); }
  void notify_all() noexcept { condition_.notify_all(); }

  template <class Ready>
  void wait(Mutex& mutex, Ready ready) SEGUE_REQUIRES(mutex) {
    Held held(mutex);
    condition_.wait(held.lock, std::move(ready));
  }
  /// Waits until `ready` says so, or until the deadline; returns whether it is ready then.
  template <class Ready>
  bool wait_until(Mutex& mutex, TimePoint deadline, Ready ready) SEGUE_REQUIRES(mutex) {
    Held held(mutex);
    return condition_.wait_until(held.lock, deadline, std::move(ready));
  }
  template <class Ready>
  bool wait_for(Mutex& mutex, Duration longest, Ready ready) SEGUE_REQUIRES(mutex) {
    Held held(mutex);
    return condition_.wait_for(held.lock, longest, std::move(ready));
  }
  /// Waits until somebody notifies; may also return without a reason.
  void wait(Mutex& mutex) SEGUE_REQUIRES(mutex) {
    Held held(mutex);
    condition_.wait(held.lock);
  }
  /// Waits until somebody notifies, until the deadline, or without a reason.
  void wait_until(Mutex& mutex, TimePoint deadline) SEGUE_REQUIRES(mutex) {
    Held held(mutex);
    condition_.wait_until(held.lock, deadline);
  }

 private:
  /// Adopts a mutex that the caller holds as the std::unique_lock that the standard's wait takes, and leaves
  /// it locked at the end.
  struct Held {
    explicit Held(Mutex& mutex) : lock(mutex.mutex_, std::adopt_lock) {}
    ~Held() { static_cast<void>(lock.release()); }
    Held(const Held&) = delete;
    Held& operator=(const Held&) = delete;
    std::unique_lock<std::mutex> lock;
  };
  std::condition_variable condition_;
};

/// std::condition_variable_any: a wait also ends when a stop is requested. Returns whether it is ready.
class StoppableConditionVariable {
 public:
  void notify_one() noexcept { condition_.notify_one(); }
  void notify_all() noexcept { condition_.notify_all(); }

  template <class Ready>
  bool wait(Mutex& mutex, const std::stop_token& stop, Ready ready) SEGUE_REQUIRES(mutex) {
    return condition_.wait(mutex.mutex_, stop, std::move(ready));
  }
  template <class Ready>
  bool wait_until(Mutex& mutex, const std::stop_token& stop, TimePoint deadline, Ready ready)
      SEGUE_REQUIRES(mutex) {
    return condition_.wait_until(mutex.mutex_, stop, deadline, std::move(ready));
  }
  template <class Ready>
  bool wait_for(Mutex& mutex, const std::stop_token& stop, Duration longest, Ready ready)
      SEGUE_REQUIRES(mutex) {
    return condition_.wait_for(mutex.mutex_, stop, longest, std::move(ready));
  }

 private:
  std::condition_variable_any condition_;
};

}  // namespace segue
