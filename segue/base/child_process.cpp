// SPDX-License-Identifier: Apache-2.0
#include <segue/base/child_process.hpp>

#include <segue/base/error.hpp>
#include <segue/base/text.hpp>

#include <fcntl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <string_view>

namespace segue {

namespace {

/// The environment of this process as "NAME=value", overridden by `more`.
std::vector<std::string> merged_environment(const std::vector<std::pair<std::string, std::string>>& more) {
  std::vector<std::string> result;
  for (char** entry = environ; entry != nullptr && *entry != nullptr; ++entry) {
    const std::string_view text(*entry);
    const auto name = text.substr(0, text.find('='));
    if (std::ranges::find(more, name, [](const auto& each) { return std::string_view(each.first); }) ==
        more.end()) {
      result.emplace_back(text);
    }
  }
  for (const auto& [name, value] : more)
    result.emplace_back(name).append("=").append(value);
  return result;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> result;
  result.reserve(texts.size() + 1);
  for (std::string& text : texts)
    result.push_back(text.data());
  result.push_back(nullptr);
  return result;
}

}  // namespace

ChildProcess::ChildProcess(int first_free) : first_free_(first_free) {
  ::posix_spawn_file_actions_init(&actions_);
  ::posix_spawnattr_init(&attributes_);
  sigset_t none;
  sigset_t all;
  ::sigemptyset(&none);
  ::sigfillset(&all);
  ::posix_spawnattr_setsigmask(&attributes_, &none);
  ::posix_spawnattr_setsigdefault(&attributes_, &all);
  ::posix_spawnattr_setpgroup(&attributes_, 0);
  ::posix_spawnattr_setflags(&attributes_,
                             POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
}

ChildProcess::~ChildProcess() {
  ::posix_spawn_file_actions_destroy(&actions_);
  ::posix_spawnattr_destroy(&attributes_);
}

/// Sources are first duplicated above all numbers of the child, so that none is overwritten before its turn.
Result<void> ChildProcess::hand_over(int source, int number) {
  Descriptor moved(::fcntl(source, F_DUPFD_CLOEXEC, first_free_));
  if (!moved.valid()) return system_error("cannot hand a descriptor to a process", errno);
  const int reason = ::posix_spawn_file_actions_adddup2(&actions_, moved.get(), number);
  moved_.push_back(std::move(moved));
  if (reason != 0) return system_error("cannot hand a descriptor to a process", reason);
  return {};
}

Result<void> ChildProcess::open_null(int number) {
  const Descriptor null(::open("/dev/null", O_RDWR | O_CLOEXEC));
  if (!null.valid()) return system_error("cannot open /dev/null", errno);
  return hand_over(null.get(), number);
}

Result<void> ChildProcess::set_folder(const std::string& folder) {
  const int reason = ::posix_spawn_file_actions_addchdir_np(&actions_, folder.c_str());
  if (reason != 0) return system_error("cannot start a process in " + quote(folder), reason);
  return {};
}

Result<pid_t> ChildProcess::start(const std::string& program, std::vector<std::string> words,
                                  const std::string& what) {
  ::posix_spawn_file_actions_addclosefrom_np(&actions_, first_free_);
  std::vector<std::string> variables = merged_environment(more_);
  pid_t pid = 0;
  const int reason = ::posix_spawnp(&pid, program.c_str(), &actions_, &attributes_, pointers(words).data(),
                                    pointers(variables).data());
  if (reason != 0) return system_error("cannot start " + what + quote(program), reason);
  return pid;
}

void wait_for_end(pid_t child, Duration patience) {
  const Descriptor process(static_cast<int>(::syscall(SYS_pidfd_open, child, 0)));
  const bool ended = process.valid() && wait_for_input(process.get(), patience);
  if (!ended) ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
}

}  // namespace segue
