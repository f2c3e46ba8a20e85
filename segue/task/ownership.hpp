// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task/futex.hpp>

#include <atomic>
#include <cstdint>

namespace segue::task::detail {

/// Who may touch a component now: its update, or one life-cycle verb. The update only ever tries, since its
/// thread must not wait; it is told afterwards that it missed its turn. Verbs wait, and go first.
class Ownership {
 public:
  /// For the update. False: release() will answer Retry to whoever holds or waits for it.
  bool try_acquire() noexcept {
    std::uint32_t word = word_.load(std::memory_order_relaxed);
    while (true) {
      const bool free = (word & kHeld) == 0 && word < kOneWaiter;
      if (word_.compare_exchange_weak(word, word | (free ? kHeld : kMissed), std::memory_order_acq_rel)) {
        if (free) holder_.store(this_thread(), std::memory_order_relaxed);
        return free;
      }
    }
  }

  /// For verbs. Requires that the caller does not hold it. `retry`: as for release(), when the deadline has
  /// passed.
  bool acquire(TimePoint deadline, bool& retry) noexcept;

  /// True: an update missed its turn and must be triggered again.
  [[nodiscard]] bool release() noexcept {
    holder_.store(nullptr, std::memory_order_relaxed);
    std::uint32_t word = word_.load(std::memory_order_relaxed);
    std::uint32_t next = 0;
    do {
      // With verbs waiting, the missed turn stays noted until the last of them is done.
      next = word >= kOneWaiter ? word & ~kHeld : 0;
    } while (!word_.compare_exchange_weak(word, next, std::memory_order_acq_rel));
    if (word >= kOneWaiter) futex_wake(word_, 1);
    return word < kOneWaiter && (word & kMissed) != 0;
  }

  /// Whether the calling thread holds it (is inside a hook).
  [[nodiscard]] bool is_mine() const noexcept {
    return holder_.load(std::memory_order_relaxed) == this_thread();
  }

 private:
  static const void* this_thread() noexcept;

  static constexpr std::uint32_t kHeld = 1;
  static constexpr std::uint32_t kMissed = 2;
  static constexpr std::uint32_t kOneWaiter = 4;  ///< waiting verbs are counted from here
  std::atomic<std::uint32_t> word_{0};
  std::atomic<const void*> holder_{nullptr};
};

}  // namespace segue::task::detail
