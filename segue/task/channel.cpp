// SPDX-License-Identifier: Apache-2.0
#include <segue/task/channel.hpp>
#include <segue/task/connection_list.hpp>

#include <atomic>
#include <chrono>
#include <thread>

namespace segue::task {

std::uint64_t next_connection_number() noexcept {
  static std::atomic<std::uint64_t> number{0};  // relaxed: numbers differ, and order nothing
  return number.fetch_add(1, std::memory_order_relaxed) + 1;
}

namespace detail {

void wait_until_left(const std::atomic<std::uint64_t>& section, std::uint64_t begin) noexcept {
  constexpr int kYields = 50;
  // Pairs with L2 (ConnectionList) and D5 (Doorbell).
  for (int tries = 0; section.load(std::memory_order_acquire) == begin; ++tries) {
    if (tries < kYields) {
      std::this_thread::yield();
    } else {
      // Yielding alone would starve a preempted reader of lower priority on the same processor.
      std::this_thread::sleep_for(std::chrono::microseconds(20));
    }
  }
}

}  // namespace detail
}  // namespace segue::task
