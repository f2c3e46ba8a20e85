// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace segue {

/// Whether a process is killed, exiting or a zombie. Its locks, sockets and memory are released within
/// moments, in no particular order. False where there is no such process. Any thread.
bool is_ending(int pid);

}  // namespace segue
