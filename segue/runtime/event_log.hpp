// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/runtime/runtime.hpp>

#include <condition_variable>
#include <deque>
#include <mutex>
#include <string>
#include <vector>

namespace segue::runtime::detail {

/// Keeps the last few thousand events, numbered from 1. Thread safe.
class EventLog {
 public:
  /// `trouble`: it is trouble, although events of that kind need not be.
  void add(EventKind kind, std::string subject, std::string message, bool trouble = false);
  /// Events after `number`. Blocks until there is one, at most for `wait`, or until close().
  [[nodiscard]] std::vector<Event> after(std::uint64_t number, Duration wait) const;
  /// Wakes all waiting threads; from then on after() does not block.
  void close();

 private:
  [[nodiscard]] bool has_after(std::uint64_t number) const { return last_ > number; }

  mutable std::mutex mutex_;  ///< protects all members below
  mutable std::condition_variable added_;
  std::deque<Event> events_;
  std::uint64_t last_ = 0;
  bool closed_ = false;
};

}  // namespace segue::runtime::detail
