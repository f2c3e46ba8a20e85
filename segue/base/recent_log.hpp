// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/log.hpp>

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace segue {

/// A line that log() has got.
struct LogLine {
  std::uint64_t number = 0;  ///< rises over all lines of the process
  std::chrono::system_clock::time_point time{};
  LogLevel level = LogLevel::Info;
  std::string message;
  friend bool operator==(const LogLine&, const LogLine&) = default;
};

/// The newest lines of that source in this process, a hundred at the most, oldest first; long lines are cut
/// after 2000 bytes. Lines below the log level are not kept. Lines of 256 sources are kept; those of the
/// source that has been silent for the longest time are dropped first. Any thread; blocks as log() does.
std::vector<LogLine> recent_log(std::string_view source);

namespace detail {
/// For log() alone.
void keep_line(LogLevel level, std::string_view source, std::string_view message);
}  // namespace detail

}  // namespace segue
