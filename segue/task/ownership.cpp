// SPDX-License-Identifier: Apache-2.0
#include <segue/task/ownership.hpp>

namespace segue::task::detail {

const void* Ownership::this_thread() noexcept {
  // Reached without a call, since every update looks at it.
  [[gnu::tls_model("initial-exec")]] thread_local const char tag = 0;
  return &tag;
}

bool Ownership::acquire(TimePoint deadline, bool& retry) noexcept {
  std::uint32_t word = word_.fetch_add(kOneWaiter, std::memory_order_acq_rel) + kOneWaiter;  // O1
  while (true) {
    if ((word & kHeld) == 0) {
      const std::uint32_t held = (word | kHeld) - kOneWaiter;
      if (!word_.compare_exchange_weak(word, held, std::memory_order_acq_rel)) continue;  // O1
      holder_.store(this_thread(), std::memory_order_relaxed);
      return true;
    }
    const bool in_time = futex_wait(word_, word, deadline);
    word = word_.load(std::memory_order_acquire);
    if (in_time || (word & kHeld) == 0) continue;
    std::uint32_t next = 0;
    do {
      next = word - kOneWaiter;
      // Nobody else is left to report the missed turn, so this verb does.
      if (next == kMissed) next = 0;
    } while (!word_.compare_exchange_weak(word, next, std::memory_order_acq_rel));  // O1
    retry = next == 0 && word == kOneWaiter + kMissed;
    // The release may have woken this waiter instead of one that still waits: pass the wake-up on.
    if (next >= kOneWaiter && (next & kHeld) == 0) futex_wake(word_, 1);
    return false;
  }
}

}  // namespace segue::task::detail
