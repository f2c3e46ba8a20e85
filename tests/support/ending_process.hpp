// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>

namespace segue::testing {

/// A process that has ended but is not reaped (a zombie) for the lifetime of this object.
class EndingProcess {
 public:
  EndingProcess() : pid_(::fork()) {
    if (pid_ == 0) ::_exit(0);
    siginfo_t end{};
    while (::waitid(P_PID, static_cast<id_t>(pid_), &end, WEXITED | WNOWAIT) != 0) {
    }
  }
  ~EndingProcess() { ::waitpid(pid_, nullptr, 0); }
  EndingProcess(const EndingProcess&) = delete;
  EndingProcess& operator=(const EndingProcess&) = delete;

  [[nodiscard]] int pid() const { return pid_; }

 private:
  int pid_;
};

}  // namespace segue::testing
