// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <thread>

namespace segue::testing {

/// How long a test waits for what must happen, on a machine that is busy with other work.
inline constexpr std::chrono::seconds kPatience{150};

/// Whether `condition` comes true within `limit`. It is asked at short intervals first, then every 2 ms. For
/// what notifies nobody in the test, above all the state of another process; where there is an event, a
/// future or a virtual clock, wait for that instead.
template <class Condition>
[[nodiscard]] bool eventually(Condition&& condition, std::chrono::steady_clock::duration limit = kPatience) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  for (int asked = 1; !condition(); ++asked) {
    if (std::chrono::steady_clock::now() >= deadline) return false;
    if (asked < 100)
      std::this_thread::yield();
    else
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

}  // namespace segue::testing
