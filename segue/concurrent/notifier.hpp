// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/condition_variable.hpp>
#include <segue/base/log.hpp>
#include <segue/base/mutex.hpp>
#include <segue/concurrent/thread.hpp>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <string>
#include <thread>
#include <utility>

namespace segue::concurrent {

/// Passes events to a listener in the order in which they were posted, on a thread of its own, so that
/// whoever posts never waits for whoever listens. All functions may be called from any thread.
template <class Event>
class Notifier {
 public:
  using Listener = std::function<void(const Event&)>;

  /// While there is no listener, the last `kept` events are kept for the next one.
  explicit Notifier(std::size_t kept = 0) : kept_(kept) {}
  Notifier(const Notifier&) = delete;
  Notifier& operator=(const Notifier&) = delete;
  ~Notifier() { halt(); }

  /// Replaces the listener; an empty one ends the thread. No call of the previous listener is in progress
  /// when this returns. Must not be called by a listener.
  void set_listener(Listener listener) {
    const Lock setting(setting_);
    halt();
    if (!listener) {
      return;
    }
    const Lock lock(mutex_);
    listener_ = std::move(listener);
    running_ = true;
    thread_ = start_thread("segue-events", [this] { run(); });
  }

  /// Returns at once.
  void post(Event event) {
    {
      const Lock lock(mutex_);
      waiting_.push_back(std::move(event));
      ++posted_;
      if (!running_) {
        drop_oldest();
      }
    }
    changed_.notify_all();
  }

  /// Waits until all that was posted before has been passed on, or there is no listener. Must not be called
  /// by a listener, and waits as long as one takes.
  void drain() {
    Lock lock(mutex_);
    const std::uint64_t last = posted_;
    changed_.wait(mutex_, [&]() SEGUE_REQUIRES(mutex_) { return !running_ || passed_ >= last; });
  }

 private:
  void drop_oldest() SEGUE_REQUIRES(mutex_) {
    while (waiting_.size() > kept_) {
      waiting_.pop_front();
      ++passed_;
    }
  }

  void halt() {
    {
      const Lock lock(mutex_);
      running_ = false;
      drop_oldest();
    }
    changed_.notify_all();
    if (thread_.joinable()) {
      thread_.join();
    }
  }

  void run() {
    Lock lock(mutex_);
    while (true) {
      changed_.wait(mutex_, [&]() SEGUE_REQUIRES(mutex_) { return !running_ || !waiting_.empty(); });
      if (!running_) {
        return;
      }
      const Event event = std::move(waiting_.front());
      waiting_.pop_front();
      lock.unlock();
      try {
        listener_(event);
      } catch (const std::exception& exception) {
        log(LogLevel::Error, "events", std::string("a listener threw: ") + exception.what());
      }
      lock.lock();
      ++passed_;
      changed_.notify_all();
    }
  }

  const std::size_t kept_;
  Mutex setting_;  ///< one set_listener() at a time
  Mutex mutex_;
  ConditionVariable changed_;
  std::deque<Event> waiting_ SEGUE_GUARDED_BY(mutex_);
  std::uint64_t posted_ SEGUE_GUARDED_BY(mutex_) = 0;
  std::uint64_t passed_ SEGUE_GUARDED_BY(mutex_) = 0;  ///< to the listener, or dropped
  bool running_ SEGUE_GUARDED_BY(mutex_) = false;
  Listener listener_;  ///< only changed while there is no thread
  std::thread thread_;
};

}  // namespace segue::concurrent
