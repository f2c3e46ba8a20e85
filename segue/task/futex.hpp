// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>

#include <atomic>
#include <cstdint>

namespace segue::task::detail {

/// A point in time that never comes.
inline constexpr TimePoint kNever = TimePoint::max();

/// Sleeps while `word` holds `expected`, until a wake or `deadline` (real monotonic time). False only when
/// the deadline has passed; may return early for no reason.
bool futex_wait(const std::atomic<std::uint32_t>& word, std::uint32_t expected, TimePoint deadline) noexcept;
void futex_wake(const std::atomic<std::uint32_t>& word, int count) noexcept;

}  // namespace segue::task::detail
