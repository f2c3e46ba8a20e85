// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/log.hpp>
#include <segue/base/mutex.hpp>

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>

namespace segue::task {

/// The process's ring of log lines from update paths: threads add lines without waiting or allocating, and
/// drain() passes them on to segue::log.
class RealtimeLog {
 public:
  static constexpr std::size_t kLines = 1024;
  static constexpr std::size_t kMessageBytes = 200;
  static constexpr std::size_t kSourceBytes = 40;

  /// The instance for components. Its memory is allocated with the first task.
  static RealtimeLog& instance();
  RealtimeLog();

  /// Cuts text that is too long. False, and counted, where the ring is full. Real-time safe.
  bool push(LogLevel level, std::string_view source, std::string_view message) noexcept;
  /// Passes all lines on and reports how many were lost. Returns the number of lines. Any thread.
  std::size_t drain();
  [[nodiscard]] std::uint64_t lost() const { return lost_.load(std::memory_order_relaxed); }

 private:
  struct Line {
    std::atomic<std::size_t> turn{0};
    LogLevel level = LogLevel::Info;
    std::uint8_t source_size = 0;
    std::uint8_t message_size = 0;
    std::array<char, kSourceBytes> source{};
    std::array<char, kMessageBytes> message{};
  };
  bool pop(Line& line) noexcept;

  std::unique_ptr<std::array<Line, kLines>> lines_;
  alignas(64) std::atomic<std::size_t> head_{0};
  alignas(64) std::atomic<std::size_t> tail_{0};
  Mutex draining_;  ///< so that lines are passed on in their order, and all have been where drain() returns
  std::atomic<std::uint64_t> lost_{0};  ///< both relaxed: counts for a message, which order nothing
  std::atomic<std::uint64_t> lost_reported_{0};
};

/// Drains the ring every `period` on a thread of its own, as long as an object lives.
class RealtimeLogDrain {
 public:
  explicit RealtimeLogDrain(std::chrono::milliseconds period = std::chrono::milliseconds(50));
  RealtimeLogDrain(const RealtimeLogDrain&) = delete;
  RealtimeLogDrain& operator=(const RealtimeLogDrain&) = delete;
  ~RealtimeLogDrain();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::task
