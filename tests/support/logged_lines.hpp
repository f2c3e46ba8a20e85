// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/condition_variable.hpp>
#include <segue/base/log.hpp>
#include <segue/base/mutex.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <string_view>
#include <vector>

namespace segue::testing {

/// Keeps what is logged.
class LoggedLines {
 public:
  LoggedLines() {
    set_log_sink([this](LogLevel, std::string_view, std::string_view message) {
      const Lock lock(mutex_);
      lines_.emplace_back(message);
      changed_.notify_all();
    });
  }
  ~LoggedLines() { set_log_sink({}); }
  LoggedLines(const LoggedLines&) = delete;
  LoggedLines& operator=(const LoggedLines&) = delete;

  /// Waits for a line that has all `parts`.
  ::testing::AssertionResult has(const std::vector<std::string>& parts) {
    const auto fits = [&](const std::string& line) {
      return std::ranges::all_of(parts,
                                 [&](const auto& part) { return line.find(part) != std::string::npos; });
    };
    Lock lock(mutex_);
    if (changed_.wait_until(mutex_, std::chrono::steady_clock::now() + std::chrono::seconds(60),
                            [&] { return std::ranges::any_of(lines_, fits); })) {
      return ::testing::AssertionSuccess();
    }
    std::string all;
    for (const auto& line : lines_)
      all += '\n' + line;
    return ::testing::AssertionFailure() << "logged:" << all;
  }
  std::size_t count() {
    const Lock lock(mutex_);
    return lines_.size();
  }

 private:
  Mutex mutex_;
  ConditionVariable changed_;
  std::vector<std::string> lines_;
};

}  // namespace segue::testing
