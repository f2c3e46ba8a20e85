// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/mutex.hpp>

#include <kj/async-io.h>

#include <functional>
#include <future>
#include <thread>
#include <vector>

namespace segue::control::detail {

/// For KJ's timers: no less than 0, and 30 days at most.
kj::Duration to_kj(Duration duration);

/// A thread with a KJ event loop. All objects of KJ and Cap'n Proto are created, used and destroyed in it;
/// other threads only post() work. (A queue of our own instead of KJ's cross-thread promises, so that every
/// hand-over between threads uses a Mutex, which the thread sanitizer understands.)
class EventLoop {
 public:
  using Work = std::function<void(kj::AsyncIoContext& io)>;

  /// Starts the thread. Throws std::system_error or kj::Exception where the system has no resources.
  EventLoop();
  /// stop() and join.
  ~EventLoop();
  EventLoop(const EventLoop&) = delete;
  EventLoop& operator=(const EventLoop&) = delete;

  /// Runs `work` in the loop's thread, in the order of posting. Work that throws is dropped. False (and
  /// `work` is destroyed by the caller) after stop().
  bool post(Work work);
  /// post() and wait for the end of `work`. False after stop(). Not from the loop's own thread.
  bool run(const Work& work);
  /// Ends the loop once all work posted before is done. Returns at once.
  void stop();
  /// Only in the loop's thread.
  [[nodiscard]] kj::Timer& timer() const { return *timer_; }

 private:
  void main(std::promise<void>& ready);
  void serve(kj::AsyncIoContext& io);
  bool drain(kj::AsyncIoContext& io);
  void wake() const;

  int event_ = -1;
  Mutex mutex_;
  std::vector<Work> queue_ SEGUE_GUARDED_BY(mutex_);
  bool stopped_ SEGUE_GUARDED_BY(mutex_) = false;
  kj::Timer* timer_ = nullptr;  ///< set before the constructor returns
  std::thread thread_;
};

}  // namespace segue::control::detail
