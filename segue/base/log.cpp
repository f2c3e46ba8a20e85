// SPDX-License-Identifier: Apache-2.0
#include <segue/base/log.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/printable.hpp>
#include <segue/base/recent_log.hpp>

#include <array>
#include <atomic>
#include <cstdio>
#include <utility>

namespace segue {
namespace {

std::atomic<LogLevel> threshold{LogLevel::Info};  // relaxed: a line at the time of the change may be either

struct Output {
  Mutex mutex;  ///< guards sink, and is held while it is called
  LogSink sink;
};

/// Never destroyed: threads may log while the process exits.
Output& output() {
  static auto* instance = new Output;
  return *instance;
}

}  // namespace

std::string_view to_string(LogLevel level) {
  static constexpr std::array<std::string_view, 4> kNames = {"debug", "info", "warning", "error"};
  return kNames.at(static_cast<std::size_t>(level));
}

void log(LogLevel level, std::string_view source, std::string_view message) {
  if (level < threshold.load(std::memory_order_relaxed)) return;
  detail::keep_line(level, source, message);
  Lock lock(output().mutex);
  if (output().sink) {
    output().sink(level, source, message);
    return;
  }
  const std::string line =
      std::string(to_string(level)) + ": " + printable(source) + ": " + printable(message) + '\n';
  std::fwrite(line.data(), 1, line.size(), stderr);
}

void set_log_level(LogLevel level) {
  threshold.store(level, std::memory_order_relaxed);
}

void set_log_sink(LogSink sink) {
  Lock lock(output().mutex);
  output().sink = std::move(sink);
}

}  // namespace segue
