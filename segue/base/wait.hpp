// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/error.hpp>

#include <chrono>
#include <stop_token>
#include <utility>

namespace segue {

/// How long a caller waits for an answer: `10s` or until `deadline` at most, and only until a stop is
/// requested. Whoever is asked fails with DeadlineExceeded or, at once, with Cancelled; after the stop it
/// begins nothing.
struct Wait {
  Wait() = default;  ///< for nothing
  // Most callers have a deadline only.
  Wait(TimePoint until) : deadline(until) {}  // NOLINT(google-explicit-constructor)
  template <class Rep, class Period>
  Wait(std::chrono::duration<Rep, Period> within)  // NOLINT(google-explicit-constructor)
      : deadline(Deadline(within)) {}
  Wait(Deadline until, std::stop_token token) : deadline(until), stop(std::move(token)) {}

  TimePoint deadline{};
  std::stop_token stop{};

  [[nodiscard]] bool is_stopped() const { return stop.stop_requested(); }
};

/// The answer to a caller that does not wait any longer.
inline Error no_longer_wanted() {
  return {ErrorCode::Cancelled, "whoever asked for it wants it no longer", {}, {}, {}};
}

}  // namespace segue
