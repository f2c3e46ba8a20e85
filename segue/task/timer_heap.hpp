// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/task/futex.hpp>

#include <cstdint>

namespace segue::task::detail {

/// A job's place in a TimerHeap. The heap links these, so setting a timer allocates nothing.
class Timer {
 public:
  Timer() = default;
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;
  [[nodiscard]] TimePoint due() const noexcept { return due_; }

 protected:
  ~Timer() = default;

 private:
  friend class TimerHeap;
  TimePoint due_{};
  bool set_ = false;
  /// Number of timers on the way to the nearest missing child, this one included.
  std::uint32_t rank_ = 1;
  Timer* parent_ = nullptr;
  Timer* left_ = nullptr;
  Timer* right_ = nullptr;
};

/// Timers by due time: a leftist heap, in which setting, clearing and finding the next one take a time that
/// grows with the logarithm of their number. Not thread safe; real-time safe.
class TimerHeap {
 public:
  /// Null where none is set.
  [[nodiscard]] Timer* first() const noexcept { return root_; }
  [[nodiscard]] TimePoint next_due() const noexcept { return root_ == nullptr ? kNever : root_->due_; }
  /// Sets a timer, or changes when it is due.
  void set(Timer& timer, TimePoint due) noexcept;
  /// Does nothing where it is not set.
  void clear(Timer& timer) noexcept;

 private:
  static std::uint32_t rank(const Timer* timer) noexcept { return timer == nullptr ? 0 : timer->rank_; }
  static Timer* merge(Timer* one, Timer* other) noexcept;

  Timer* root_ = nullptr;
};

}  // namespace segue::task::detail
