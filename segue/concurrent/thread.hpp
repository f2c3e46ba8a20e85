// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <stop_token>
#include <thread>

/// Threads, and ways to pass work between them. Built on base only.
namespace segue::concurrent {

/// Blocks all signals in the calling thread but those that report its own faults: signals are handled by the
/// main thread, or by whoever waits for them.
void block_signals();

/// Starts a thread with that name (15 characters at most), all signals blocked and short time slices. Throws
/// std::system_error where the system has no thread left.
std::thread start_thread(const char* name, std::function<void()> work);

/// Starts a thread like start_thread(), with a token by which `work` is asked to stop, at the latest where
/// the thread is destroyed, which waits for its end.
std::jthread start_stoppable_thread(const char* name, std::function<void(const std::stop_token& stop)> work);

}  // namespace segue::concurrent
