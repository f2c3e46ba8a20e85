// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "action_messages.hpp"

#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>

#include <sys/timerfd.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <ctime>

namespace ros2 {

/// The state of a goal for a task whose states follow it. Other threads tell it, and states are entered by
/// updates: they set a timer to now, which drives the task (trigger_fd).
class ToldState {
 public:
  segue::Result<void> open() {
    timer_ = segue::Descriptor(::timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC));
    if (timer_.valid()) return {};
    return segue::fail(segue::ErrorCode::Unavailable, "the system has no timer left");
  }
  void close() { timer_ = segue::Descriptor(); }
  [[nodiscard]] int descriptor() const { return timer_.get(); }

  /// At the start of the task: nothing has been told.
  void begin() {
    told_ = 0;
    entered_ = 0;
    ask_for_update();
  }
  /// One thread at a time.
  void tell(GoalState state) noexcept {
    told_ = ((told_ & ~kStateMask) + kOneChange) | static_cast<std::uint32_t>(state);
    ask_for_update();
  }
  void ask_for_update() const noexcept {
    const itimerspec times{{0, kBetweenUpdates}, {0, 1}};
    ::timerfd_settime(timer_.get(), 0, &times, nullptr);
  }

  /// In each update: `enter` gets a state that was told since the last one.
  template <class Enter>
  void update(Enter&& enter) {
    std::uint64_t expirations = 0;
    static_cast<void>(::read(timer_.get(), &expirations, sizeof expirations));
    const std::uint32_t told = told_;
    if (told == entered_) return;
    enter(static_cast<GoalState>(told & kStateMask));
    entered_ = told;
  }
  /// The latest that was told, for has_entered(). Any thread.
  [[nodiscard]] std::uint32_t told() const { return told_; }
  /// Whether that, or something later, has been entered. The differences of two counters that wrap.
  [[nodiscard]] bool has_entered(std::uint32_t told) const {
    return static_cast<std::int32_t>(entered_ - told) >= 0;
  }

 private:
  static constexpr std::uint32_t kStateMask = 0xf;
  static constexpr std::uint32_t kOneChange = 0x10;
  /// Who waits for a state of the task counts from an update after he has told it something, so there is one
  /// from time to time.
  static constexpr long kBetweenUpdates = 100'000'000;  // ns

  segue::Descriptor timer_;
  std::atomic<std::uint32_t> told_{0};     ///< a GoalState, and how often it has changed
  std::atomic<std::uint32_t> entered_{0};  ///< the latest of them that is the task's state
};

}  // namespace ros2
