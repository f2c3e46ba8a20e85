// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/log.hpp>

#include <cstdint>
#include <string>

namespace segue::web::detail {

/// Logs refused requests, at most one a second where they are many. Calls must exclude each other.
class Refusals {
 public:
  void add(const std::string& what) {
    const TimePoint now = monotonic_now();
    if (now < next_) {
      ++unsaid_;
      return;
    }
    next_ = now + std::chrono::seconds(1);
    log(LogLevel::Warning, "studio",
        "refused: " + what + (unsaid_ > 0 ? " (and " + std::to_string(unsaid_) + " others before)" : ""));
    unsaid_ = 0;
  }

 private:
  TimePoint next_{};
  std::uint64_t unsaid_ = 0;
};

}  // namespace segue::web::detail
