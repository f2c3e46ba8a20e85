// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>
#include <segue/task/sample.hpp>

#include <sys/eventfd.h>

#include <atomic>

namespace ros2 {

/// Hands samples from updates, which must not wait, to another thread: the latest one, in place of one that
/// has not been taken yet.
class SampleHandover {
 public:
  SampleHandover() = default;
  SampleHandover(const SampleHandover&) = delete;
  SampleHandover& operator=(const SampleHandover&) = delete;
  ~SampleHandover() { take(); }

  void give(segue::task::SampleRef sample) noexcept {
    segue::task::SampleRef::adopt(slot_.exchange(sample.detach()));
  }
  /// Empty where there is none.
  segue::task::SampleRef take() noexcept { return segue::task::SampleRef::adopt(slot_.exchange(nullptr)); }

 private:
  std::atomic<segue::task::SampleSlot*> slot_{nullptr};  ///< a counted reference
};

/// Wakes the thread that waits for it. Real-time safe for who wakes.
class ThreadWaker {
 public:
  segue::Result<void> open() {
    event_ = segue::Descriptor(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC));
    if (event_.valid()) return {};
    return segue::fail(segue::ErrorCode::Unavailable, "the system has no descriptor left");
  }
  void wake() const noexcept { ::eventfd_write(event_.get(), 1); }
  /// Until wake(), which may have come before, or until the deadline.
  void wait(segue::Deadline deadline) const {
    segue::wait_for_input(event_.get(), deadline);
    eventfd_t wakes = 0;
    ::eventfd_read(event_.get(), &wakes);
  }

 private:
  segue::Descriptor event_;
};

}  // namespace ros2
