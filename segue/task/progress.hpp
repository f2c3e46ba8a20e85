// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/task/futex.hpp>

#include <atomic>
#include <cstdint>
#include <optional>
#include <string_view>

namespace segue::task::detail {

/// The work in progress in a task's thread: an update or operations. Written by that thread alone, real-time
/// safe; read by any thread. Times are those of the executor's clock.
///
/// Memory order: `overdue_at_` is released last and acquired first (P1), so whoever finds it past sees at
/// least the `what_` and `next_due_` that belong to it. These two are relaxed. A reader may see newer values
/// of them, but then the execution that was overdue has ended, and the next reading tells so.
class Progress {
 public:
  enum class What : std::uint8_t { Update, Error, Operation };

  /// `next_due`: when the next update of a periodic task is due; kNever for other tasks.
  void begin(What what, TimePoint overdue_at, TimePoint next_due) noexcept {
    what_.store(what, std::memory_order_relaxed);
    next_due_.store(next_due.time_since_epoch().count(), std::memory_order_relaxed);
    overdue_at_.store(overdue_at.time_since_epoch().count(), std::memory_order_release);  // P1
  }
  void end() noexcept { overdue_at_.store(kNothing, std::memory_order_release); }  // P1

  /// The time when the work in progress will be overdue; kNever where there is none.
  [[nodiscard]] TimePoint overdue_at() const noexcept {
    return TimePoint(Duration(overdue_at_.load(std::memory_order_acquire)));  // pairs with P1
  }
  /// The call that is overdue at `now`: "on_update", "on_error" or "an operation"; nothing if none is.
  [[nodiscard]] std::optional<std::string_view> overdue(TimePoint now) const noexcept;
  /// Periods that have passed without an update since the one in progress began; 0 where none is.
  [[nodiscard]] std::uint64_t missed(TimePoint now, Duration period) const noexcept;

 private:
  static constexpr std::int64_t kNothing = kNever.time_since_epoch().count();

  std::atomic<std::int64_t> overdue_at_{kNothing};
  std::atomic<std::int64_t> next_due_{kNothing};
  std::atomic<What> what_{What::Update};
};

}  // namespace segue::task::detail
