// SPDX-License-Identifier: Apache-2.0
#include "process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <fstream>
#include <stdexcept>
#include <string>

extern char** environ;

namespace segue::testing {

namespace {

using Clock = std::chrono::steady_clock;

struct Pipe {
  std::array<int, 2> ends{};
  Pipe() {
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("pipe2");
  }
};

std::chrono::milliseconds left_until(Clock::time_point deadline) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now());
  return std::max(left, std::chrono::milliseconds(0));
}

/// What somebody types Ctrl-C for must hear it, even where the tests run in the background of a shell, which
/// has them ignore it.
posix_spawnattr_t hearing_interrupts() {
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t interrupts;
  sigemptyset(&interrupts);
  sigaddset(&interrupts, SIGINT);
  sigaddset(&interrupts, SIGQUIT);
  posix_spawnattr_setsigdefault(&attributes, &interrupts);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
  return attributes;
}

pid_t spawn(const std::vector<std::string>& command, const std::filesystem::path& folder, int output,
            int errors, bool input_is_terminal = false) {
  std::vector<char*> arguments;
  for (const std::string& word : command)
    arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  // The first terminal that the leader of a session opens becomes that of its processes.
  const std::string input = input_is_terminal ? ::ttyname(output) : "/dev/null";
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, input.c_str(), O_RDWR, 0);
  posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, errors, STDERR_FILENO);
  posix_spawnattr_t attributes = hearing_interrupts();
  if (input_is_terminal) posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSID);
  pid_t pid = -1;
  const int failed =
      ::posix_spawn(&pid, command.front().c_str(), &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) throw std::runtime_error("cannot start " + command.front());
  return pid;
}

bool blocks(pid_t pid, int signal) {
  const std::string key = "SigBlk:";
  std::ifstream status("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (!line.starts_with(key)) continue;
    const auto mask = std::stoull(line.substr(key.size()), nullptr, 16);
    return (mask >> (signal - 1) & 1U) != 0;
  }
  return false;
}

}  // namespace

Process::Process(const std::vector<std::string>& command, const std::filesystem::path& folder) {
  const Pipe output;
  const Pipe errors;
  pid_ = spawn(command, folder, output.ends[1], errors.ends[1]);
  ::close(output.ends[1]);
  ::close(errors.ends[1]);
  output_ = output.ends[0];
  errors_ = errors.ends[0];
}

Process::~Process() {
  if (pid_ >= 0) {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  if (output_ >= 0) ::close(output_);
  if (errors_ >= 0) ::close(errors_);
}

void Process::signal(int number) const {
  ::kill(pid_, number);
}

bool Process::wait_until_blocked(int signal) const {
  bool blocked = false;
  (void)eventually([&] { return (blocked = blocks(pid_, signal)) || has_ended(); });
  return blocked;
}

bool Process::has_ended() const {
  siginfo_t info{};
  const int failed = ::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT);
  return failed != 0 || info.si_pid == pid_;
}

bool Process::read_from(int& descriptor, std::string& into) {
  std::array<char, 65536> buffer{};
  const auto got = ::read(descriptor, buffer.data(), buffer.size());
  if (got > 0) {
    into.append(buffer.data(), static_cast<std::size_t>(got));
    return true;
  }
  ::close(descriptor);
  descriptor = -1;
  return false;
}

bool Process::pump(std::chrono::milliseconds limit) {
  std::array<pollfd, 2> waited = {{{output_, POLLIN, 0}, {errors_, POLLIN, 0}}};
  if (::poll(waited.data(), waited.size(), static_cast<int>(limit.count())) <= 0) return true;
  if (output_ >= 0 && waited[0].revents != 0) read_from(output_, finished_.output);
  if (errors_ >= 0 && waited[1].revents != 0) read_from(errors_, finished_.errors);
  return output_ >= 0 || errors_ >= 0;
}

bool Process::wait_until(const std::function<bool(const std::string& output)>& condition) {
  const auto deadline = Clock::now() + kPatience;
  while (!condition(finished_.output)) {
    if (Clock::now() >= deadline || output_ < 0) return false;
    pump(left_until(deadline));
  }
  return true;
}

bool Process::wait_for(const std::string& text) {
  return wait_until([&](const std::string& output) { return output.find(text) != std::string::npos; });
}

void Process::close_output() {
  ::close(output_);
  output_ = -1;
}

Finished Process::wait(std::chrono::seconds limit) {
  const auto deadline = Clock::now() + limit;
  while (output_ >= 0 || errors_ >= 0) {
    if (Clock::now() >= deadline) {
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, nullptr, 0);
      pid_ = -1;
      return finished_;
    }
    pump(left_until(deadline));
  }
  int status = 0;
  ::waitpid(pid_, &status, 0);
  pid_ = -1;
  finished_.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return finished_;
}

Finished run(const std::vector<std::string>& command, const std::filesystem::path& folder) {
  return Process(command, folder).wait();
}

Finished run_on_terminal(const std::vector<std::string>& command, const std::filesystem::path& folder,
                         const Terminal& kind) {
  int master = -1;
  int terminal = -1;
  const winsize size{kind.rows, kind.columns, 0, 0};
  if (::openpty(&master, &terminal, nullptr, nullptr, &size) != 0) throw std::runtime_error("openpty");
  ::fcntl(master, F_SETFD, FD_CLOEXEC);
  ::fcntl(terminal, F_SETFD, FD_CLOEXEC);
  const pid_t pid = spawn(command, folder, terminal, terminal, !kind.typed.empty());
  ::close(terminal);
  Finished finished;
  const auto deadline = Clock::now() + kPatience;
  std::array<char, 65536> buffer{};
  pollfd waited{master, POLLIN, 0};
  bool is_typed = kind.typed.empty();
  while (::poll(&waited, 1, static_cast<int>(left_until(deadline).count())) > 0) {
    const auto got = ::read(master, buffer.data(), buffer.size());
    if (got <= 0) break;  // nobody has the terminal any more
    finished.output.append(buffer.data(), static_cast<std::size_t>(got));
    if (is_typed || finished.output.find(kind.typed_after) == std::string::npos) continue;
    is_typed = true;
    if (::write(master, kind.typed.data(), kind.typed.size()) < 0) break;
  }
  ::close(master);
  const bool is_late = Clock::now() >= deadline;
  if (is_late) ::kill(pid, SIGKILL);
  int status = 0;
  ::waitpid(pid, &status, 0);
  if (!is_late) finished.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return finished;
}

}  // namespace segue::testing
