// SPDX-License-Identifier: Apache-2.0
/// A deployment process without tasks, for tests of process servers. The environment variable TEST_DO of its
/// deployment selects its behaviour.
#include <segue/process_server/assignment.hpp>
#include <segue/process_server/inherited_process.hpp>
#include <segue/process_server/process_limits.hpp>
#include <segue/process_server/process_log.hpp>
#include <segue/process_server/zygote.hpp>
#include <segue/process_server/zygote_message.hpp>

#include <signal.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

namespace {

using namespace segue;

constexpr int kNoAssignment = 90;
constexpr int kNotPermitted = 91;

/// A child that ignores SIGTERM, so that only the end of the process group ends it.
void start_stubborn_child() {
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGTERM, SIG_IGN);
    for (;;)
      ::pause();
  }
  std::printf("child %d\n", child);
}

void chatter() {
  for (int i = 0; i < 2000; ++i)
    std::printf("line %d of a log that grows\n", i);
}

/// Behaves like a process that is killed while one of its threads is in a system call: its first thread has
/// ended, and with it the command line in /proc, but its descriptors stay open until SIGTERM.
[[noreturn]] void end_slowly(process_server::InheritedProcess& process) {
  std::thread([&process] {
    while (!process.wait_for_end(std::chrono::hours(1))) {
    }
    std::_Exit(0);
  }).detach();
  std::printf("ready\n");
  for (;;)
    ::syscall(SYS_exit, 0);
}

[[noreturn]] void misbehave(const std::string& how) {
  if (how == "abort") std::abort();
  if (how == "segv") {
    ::signal(SIGSEGV, SIG_DFL);  // sanitizers have a handler of their own
    ::raise(SIGSEGV);
  }
  if (how == "status") std::_Exit(3);
  std::_Exit(kNoAssignment);
}

int run() {
  process_server::InheritedProcess process;
  const auto assignment = process_server::read_assignment(process_server::kAssignment);
  if (!assignment) return kNoAssignment;
  if (!process_server::apply_to_this_process(assignment->launch)) return kNotPermitted;
  const char* software = std::getenv("TEST_SOFTWARE");
  process.begin(assignment->socket, software == nullptr ? "0.1.0" : software);
  const char* variable = std::getenv("TEST_DO");
  const std::string what = variable == nullptr ? "" : variable;
  if (what == "abort" || what == "segv" || what == "status") misbehave(what);
  if (what == "end slowly") end_slowly(process);
  if (what == "child") start_stubborn_child();
  if (what == "chatter") chatter();
  process_server::OutputLog output(assignment->log, assignment->log_size, assignment->log_files,
                                   process.take_output_changes());
  std::printf("ready\n");
  const Duration most =
      what == "print once" ? Duration(std::chrono::hours(1)) : std::chrono::milliseconds(20);
  if (what == "print once") chatter();
  for (;;) {
    const bool asked_to_end = process.wait_for_end(most, output.changes());
    output.rotate();
    if (what == "chatter always") chatter();
    if (asked_to_end && what != "stay") break;
  }
  std::printf("going\n");
  process.leave();
  return 0;
}

}  // namespace

int main(int count, char** words) {
  if (count > 1 && words[1] == process_server::detail::kZygoteOption) {
    const auto preload_nothing = [](const std::string&) { return segue::Result<void>(); };
    return segue::process_server::detail::run_zygote({count, words}, {preload_nothing, [] {}, &run});
  }
  return run();
}
