// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>

#include <atomic>
#include <cstdint>

namespace segue::task::detail {

/// A point in time that never comes.
inline constexpr TimePoint kNever = TimePoint::max();

/// Who may wait for a word and wake it: threads of this process, or of all processes that share its memory.
enum class FutexScope : std::uint8_t { Process, Host };

/// Sleeps while `word` holds `expected`, until a wake or `deadline` (real monotonic time). False only when
/// the deadline has passed; may return spuriously.
bool futex_wait(const std::atomic<std::uint32_t>& word, std::uint32_t expected, TimePoint deadline,
                FutexScope scope = FutexScope::Process) noexcept;
void futex_wake(const std::atomic<std::uint32_t>& word, int count,
                FutexScope scope = FutexScope::Process) noexcept;

}  // namespace segue::task::detail
