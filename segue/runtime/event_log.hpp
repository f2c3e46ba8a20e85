// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/runtime/runtime.hpp>

#include <deque>
#include <string>
#include <vector>

namespace segue::runtime::detail {

/// Keeps the last few thousand events, numbered from 1; at most a quarter of them are of properties that were
/// set. Thread safe.
class EventLog {
 public:
  /// `trouble`: it is trouble, although events of that kind need not be.
  void add(EventKind kind, std::string subject, std::string message, bool trouble = false);
  /// Events after `number`. Blocks until there is one, at most as long as `wait` says, or until close().
  [[nodiscard]] std::vector<Event> after(std::uint64_t number, const Wait& wait) const;
  /// Wakes all waiting threads; from then on after() does not block.
  void close();

 private:
  void make_room_for_property() SEGUE_REQUIRES(mutex_);
  [[nodiscard]] bool has_after(std::uint64_t number) const SEGUE_REQUIRES(mutex_) { return last_ > number; }

  mutable Mutex mutex_;  ///< protects all members below
  mutable StoppableConditionVariable added_;
  std::deque<Event> events_ SEGUE_GUARDED_BY(mutex_);
  std::size_t property_events_ SEGUE_GUARDED_BY(mutex_) = 0;
  std::uint64_t last_ SEGUE_GUARDED_BY(mutex_) = 0;
  bool closed_ SEGUE_GUARDED_BY(mutex_) = false;
};

}  // namespace segue::runtime::detail
