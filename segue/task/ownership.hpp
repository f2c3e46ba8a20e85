// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task/futex.hpp>

#include <atomic>
#include <cstdint>

namespace segue::task::detail {

/// The lock of a component, held by its update or by one life-cycle verb. The update only ever tries, since
/// its thread must not wait; if it misses its turn, that is noted and it is triggered again afterwards. Verbs
/// wait and have priority.
///
/// Memory order: every change of word_ is an acquire-release read-modify-write, so whatever a holder did
/// happens before what the next holder does (O1). A verb that waits compares word_ in the futex, so a release
/// in between is not missed. holder_ is relaxed: a thread only asks whether it is itself the holder, and it
/// sees its own stores.
class Ownership {
 public:
  /// For the update. False: the missed turn is noted, and release() reports it to the last holder.
  bool try_acquire() noexcept {
    std::uint32_t word = word_.load(std::memory_order_relaxed);
    while (true) {
      const bool free = (word & kHeld) == 0 && word < kOneWaiter;
      // O1, also where the turn is missed: what led to it happens before the release that finds it.
      if (word_.compare_exchange_weak(word, word | (free ? kHeld : kMissed), std::memory_order_acq_rel)) {
        if (free) holder_.store(this_thread(), std::memory_order_relaxed);
        return free;
      }
    }
  }

  /// For verbs: waits until `deadline`. Requires that the caller does not hold it. `retry` is set as
  /// release() returns it where the deadline has passed and nobody else is left to report the missed turn.
  bool acquire(TimePoint deadline, bool& retry) noexcept;

  /// True: an update missed its turn and must be triggered again.
  [[nodiscard]] bool release() noexcept {
    holder_.store(nullptr, std::memory_order_relaxed);
    std::uint32_t word = word_.load(std::memory_order_relaxed);
    std::uint32_t next = 0;
    do {
      // While verbs wait, the missed turn stays noted until the last of them is done.
      next = word >= kOneWaiter ? word & ~kHeld : 0;
    } while (!word_.compare_exchange_weak(word, next, std::memory_order_acq_rel));  // O1
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
  static constexpr std::uint32_t kOneWaiter = 4;  ///< the bits from here on count waiting verbs
  std::atomic<std::uint32_t> word_{0};
  std::atomic<const void*> holder_{nullptr};
};

}  // namespace segue::task::detail
