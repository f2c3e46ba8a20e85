// SPDX-License-Identifier: Apache-2.0
#include <segue/process_server/os_process.hpp>

#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

namespace segue::process_server::detail {

int open_pidfd(int pid) {
  return static_cast<int>(::syscall(SYS_pidfd_open, pid, 0));
}

int signal_pidfd(int pidfd, int signal) {
  return static_cast<int>(::syscall(SYS_pidfd_send_signal, pidfd, signal, nullptr, 0));
}

void kill_group(int pid) {
  // kill(-1) means every process of this user, kill(0) our own group.
  if (pid > 1) ::kill(-pid, SIGKILL);
}

ExitReason reap(int pidfd) {
  siginfo_t ended{};
  int done = 0;
  do {
    done = ::waitid(P_PIDFD, static_cast<id_t>(pidfd), &ended, WEXITED | WNOHANG);
  } while (done != 0 && errno == EINTR);
  ExitReason reason;
  reason.known = done == 0 && ended.si_pid != 0;
  if (!reason.known) return reason;
  if (ended.si_code == CLD_EXITED) {
    reason.status = ended.si_status;
  } else {
    reason.signal = ended.si_status;
    reason.core_dumped = ended.si_code == CLD_DUMPED;
  }
  return reason;
}

void reap_child(int pid) {
  siginfo_t ended{};
  while (::waitid(P_PID, static_cast<id_t>(pid), &ended, WEXITED) != 0 && errno == EINTR) {
  }
}

}  // namespace segue::process_server::detail
