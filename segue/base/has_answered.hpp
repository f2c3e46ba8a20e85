// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/wait.hpp>

#include <algorithm>
#include <chrono>
#include <future>

namespace segue {

/// Waits as long as `wait` says for the answer; false where it has not come by then. A future cannot be woken
/// by a stop, so that is seen within 5 ms.
template <class Future>
bool has_answered(const Future& answer, const Wait& wait) {
  constexpr Duration kSlice = std::chrono::milliseconds(5);
  if (!wait.stop.stop_possible()) return answer.wait_until(wait.deadline) == std::future_status::ready;
  while (!wait.is_stopped()) {
    const TimePoint now = RealClock::instance().now();
    if (answer.wait_until(std::min(wait.deadline, now + kSlice)) == std::future_status::ready) return true;
    if (now >= wait.deadline) return false;
  }
  return false;
}

}  // namespace segue
