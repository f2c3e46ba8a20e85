// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>

namespace segue {

/// How long a thread with the normal scheduler runs before others get their turn. The shorter, the sooner the
/// kernel lets it run after a wake-up where other programs use all processors: a chain of tasks waits for
/// each of its threads in turn, and so does a stop, which passes through several processes.
inline constexpr Duration kTimeSlice = std::chrono::microseconds(300);

/// Asks the kernel for time slices of kTimeSlice for the calling thread, and for the threads and processes
/// that it starts later, and changes nothing else of how it is scheduled. Needs no permission. Linux before
/// 6.12 ignores it, as do real-time schedulers.
void ask_for_short_time_slices() noexcept;

}  // namespace segue
