// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace segue {

/// Whether a process is about to be gone: killed, or exiting, or waiting only for its parent to look. What it
/// holds (locks, sockets, memory) goes within moments, in no order to rely on. False where there is no such
/// process. Any thread.
bool is_ending(int pid);

}  // namespace segue
