// SPDX-License-Identifier: Apache-2.0
#include <segue/task/progress.hpp>

namespace segue::task::detail {

std::optional<std::string_view> Progress::overdue(TimePoint now) const noexcept {
  if (now < overdue_at()) return std::nullopt;
  switch (what_.load(std::memory_order_relaxed)) {
    case What::Error:
      return "on_error";
    case What::Operation:
      return "an operation";
    case What::Update:
      break;
  }
  return "on_update";
}

std::uint64_t Progress::missed(TimePoint now, Duration period) const noexcept {
  if (period <= Duration::zero() || overdue_at() == kNever) return 0;
  const TimePoint due(Duration(next_due_.load(std::memory_order_relaxed)));
  return now < due ? 0 : static_cast<std::uint64_t>((now - due) / period);
}

}  // namespace segue::task::detail
