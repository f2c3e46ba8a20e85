// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/process_server/process_service.hpp>

/// System calls on processes and their groups. Internal.
namespace segue::process_server::detail {

/// A descriptor (close-on-exec) of a process, which becomes readable when the process ends; -1 with errno. By
/// system call, since the header of some versions of the C library cannot be used from C++.
int open_pidfd(int pid);
/// 0, or -1 with errno.
int signal_pidfd(int pidfd, int signal);

/// Kills the whole process group that `pid` leads. The caller must know that `pid` has not been reaped yet,
/// since its number may belong to another process afterwards.
void kill_group(int pid);

/// Takes the exit status of a child that has ended, which frees its pid. `known` is false where the process
/// is not a child of this one. Does not block.
ExitReason reap(int pidfd);
/// Blocks until a child that was killed has ended, and reaps it.
void reap_child(int pid);

}  // namespace segue::process_server::detail
