// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/wait.hpp>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <stop_token>
#include <thread>

namespace segue::task_host::detail {

/// Questions that wait for something in this process to change; one thread looks after all of them. Thread
/// safe.
class Watches {
 public:
  /// Changes that ring for nothing, such as a task that hangs, are seen within this.
  static constexpr Duration kPollPeriod = std::chrono::milliseconds(100);

  enum class End : std::uint8_t { No, Deadline, Stop, Closed };
  /// Looks whether what is waited for has happened, and answers if so; true once it has answered. It must at
  /// an end, and must not block.
  using Poll = std::function<bool(End end)>;

  /// Looks at least so often while somebody waits. `thread` is the name of the thread: a literal of at most
  /// 15 characters.
  explicit Watches(Duration period = kPollPeriod, const char* thread = "segue-watch")
      : period_(period), thread_name_(thread) {}
  Watches(const Watches&) = delete;
  Watches& operator=(const Watches&) = delete;
  ~Watches() { close(); }

  /// `poll` is called now, after each ring(), and at the end of `wait`, one call at a time.
  void add(Wait wait, Poll poll);
  /// Something may have changed. Real-time safe, and free while nobody waits.
  void ring() noexcept;
  /// Ends all waits; later questions end at once.
  void close();

 private:
  struct Open {
    Open(Wait until, Poll how, Watches& owner);
    const Wait wait;
    const Poll poll;
    const std::stop_callback<std::function<void()>> stopped;
  };

  void wake() noexcept;
  void run();
  /// Looks for all questions; returns the time of the next poll.
  TimePoint look_at_all(TimePoint now);
  [[nodiscard]] End end_of(const Open& open, TimePoint now) const;

  const Duration period_;
  const char* const thread_name_;
  /// W1: ring() looks at `open_count_` after the change that it stands for; add() raises that before it looks
  /// for changes (both sequentially consistent): so one of them sees the other.
  std::atomic<std::uint32_t> open_count_{0};
  /// W2: wake() raises it after its reason; the thread reads it before it looks, so the futex does not sleep
  /// over a reason.
  std::atomic<std::uint32_t> rings_{0};
  std::atomic<bool> closed_{false};  ///< set under the mutex; look_at_all() reads it without
  Mutex mutex_;                      ///< protects the next two
  std::list<std::unique_ptr<Open>> added_ SEGUE_GUARDED_BY(mutex_);
  std::optional<std::thread> thread_;
  std::list<std::unique_ptr<Open>> open_;  ///< used by the thread
};

}  // namespace segue::task_host::detail
