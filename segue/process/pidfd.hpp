// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/syscall.h>
#include <unistd.h>

/// The system's calls for pidfds; the C library's header of some versions cannot be used from C++. Internal.
namespace segue::process::detail {

/// A descriptor (close-on-exec) of a process, readable when it has ended; -1 with errno.
inline int open_pidfd(int pid) {
  return static_cast<int>(::syscall(SYS_pidfd_open, pid, 0));
}

/// 0, or -1 with errno.
inline int signal_pidfd(int pidfd, int signal) {
  return static_cast<int>(::syscall(SYS_pidfd_send_signal, pidfd, signal, nullptr, 0));
}

}  // namespace segue::process::detail
