// SPDX-License-Identifier: Apache-2.0
// Runs a program of ROS 2 and ends as it does. Usage: segue-process-guard GRACE PROGRAM ARGUMENTS...
// When descriptor 3 is closed, the program is asked to end, in steps that are GRACE milliseconds apart: by
// SIGINT, SIGTERM and SIGKILL. So it is closed when whoever started this program ends, however that happens.
// SIGTERM to this program kills the other one at once. Whatever that has started ends with it, and it ends
// with this program.
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>

namespace {

constexpr int kOwner = 3;  ///< descriptor: closed when the program is to end
constexpr int kUsage = 2;
constexpr int kCannotExecute = 126;

sigset_t awaited_signals() {
  sigset_t signals;
  ::sigemptyset(&signals);
  for (const int number : {SIGCHLD, SIGINT, SIGTERM, SIGHUP})
    ::sigaddset(&signals, number);
  return signals;
}

[[noreturn]] void execute(char** words, pid_t guard, const sigset_t& signals) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != guard) ::_exit(kCannotExecute);
  ::close(kOwner);
  ::sigprocmask(SIG_UNBLOCK, &signals, nullptr);
  ::execv(words[0], words);
  std::fprintf(stderr, "segue: cannot start %s: %s\n", words[0], std::strerror(errno));
  ::_exit(kCannotExecute);
}

/// Reaps whatever has ended. Whether the program is among them; `status` is its own then.
bool reap(pid_t program, int& status) {
  bool ended = false;
  int each = 0;
  for (pid_t pid = ::waitpid(-1, &each, WNOHANG); pid > 0; pid = ::waitpid(-1, &each, WNOHANG)) {
    if (pid != program) continue;
    ended = true;
    status = each;
  }
  return ended;
}

/// Kills what the program has left, in whatever process groups it is: orphans become children of this
/// process.
void end_orphans() {
  for (;;) {
    std::ifstream children("/proc/self/task/" + std::to_string(::getpid()) + "/children");
    for (pid_t child = 0; children >> child;)
      ::kill(child, SIGKILL);
    if (::waitpid(-1, nullptr, 0) < 0 && errno == ECHILD) return;
  }
}

/// Waits for the end of the program, and brings it about where that is wanted; its status.
int guard(pid_t program, int grace, const sigset_t& signals) {
  constexpr std::array kSteps = {SIGINT, SIGTERM, SIGKILL};
  const int events = ::signalfd(-1, &signals, SFD_CLOEXEC | SFD_NONBLOCK);
  std::array<pollfd, 2> waited = {pollfd{events, POLLIN, 0}, pollfd{kOwner, POLLIN, 0}};
  std::size_t step = 0;
  for (int status = 0;;) {
    const bool is_ending = step > 0 && step < kSteps.size();
    const int ready = ::poll(waited.data(), waited.size(), is_ending ? grace : -1);
    if (ready < 0 && errno != EINTR) ::abort();
    bool is_due = ready == 0 || (step == 0 && waited[1].revents != 0);
    if (waited[1].revents != 0) waited[1].fd = -1;
    signalfd_siginfo event{};
    while (::read(events, &event, sizeof event) == sizeof event) {
      if (event.ssi_signo == SIGTERM) step = kSteps.size() - 1;
      is_due = is_due || event.ssi_signo == SIGTERM || (step == 0 && event.ssi_signo != SIGCHLD);
    }
    if (reap(program, status)) return status;
    if (is_due && step < kSteps.size()) ::kill(-program, kSteps.at(step++));
  }
}

/// Ends as the program has, so that whoever started this one sees it.
[[noreturn]] void end_as(int status) {
  if (!WIFSIGNALED(status)) ::_exit(WEXITSTATUS(status));
  const rlimit no_core = {0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  sigset_t all;
  ::sigfillset(&all);
  ::signal(WTERMSIG(status), SIG_DFL);
  ::sigprocmask(SIG_UNBLOCK, &all, nullptr);
  ::raise(WTERMSIG(status));
  ::_exit(128 + WTERMSIG(status));
}

}  // namespace

int main(int count, char** words) {
  if (count < 3) {
    std::fputs("usage: segue-process-guard GRACE PROGRAM ARGUMENTS...\n", stderr);
    return kUsage;
  }
  const sigset_t signals = awaited_signals();
  ::sigprocmask(SIG_BLOCK, &signals, nullptr);
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);
  const pid_t self = ::getpid();
  const pid_t program = ::fork();
  if (program < 0) {
    std::perror("segue: cannot start a process");
    return kCannotExecute;
  }
  if (program == 0) execute(words + 2, self, signals);
  ::setpgid(program, program);
  const int status = guard(program, std::atoi(words[1]), signals);
  ::kill(-program, SIGKILL);
  end_orphans();
  end_as(status);
}
