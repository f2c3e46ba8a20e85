// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>

#include <cstdint>
#include <string>
#include <utility>

namespace segue {

/// Logs who was refused and why: at once as long as that is rare, and of a flood one line a second, with the
/// number of those that were left out, so that nobody can fill a disk. For one thread.
class RefusalLog {
 public:
  static constexpr int kBurst = 20;  ///< lines without a pause
  static constexpr Duration kRefill = std::chrono::seconds(1);

  /// `component`: who refuses, as of log().
  explicit RefusalLog(std::string component) : component_(std::move(component)) {}

  /// One line: "refused WHO: WHY".
  void tell(const std::string& who, const std::string& why);
  /// Says how many were left out, if it is time for a line. To be called now and then.
  void settle();

 private:
  bool take_line();

  const std::string component_;
  int lines_ = kBurst;  ///< that may be written now
  TimePoint refilled_;
  std::uint64_t left_out_ = 0;
};

}  // namespace segue
