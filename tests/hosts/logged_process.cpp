// SPDX-License-Identifier: Apache-2.0
#include "logged_process.hpp"

#include <segue/base/file.hpp>

#include <support/eventually.hpp>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <stdexcept>
#include <utility>

extern char** environ;

namespace segue::testing {

namespace {

std::vector<char*> pointers(const std::vector<std::string>& words) {
  std::vector<char*> all;
  for (const std::string& word : words)
    all.push_back(const_cast<char*>(word.c_str()));
  all.push_back(nullptr);
  return all;
}

/// The variables of this process, those in `more` replaced.
std::vector<std::string> environment_with(const std::map<std::string, std::string>& more) {
  std::vector<std::string> all;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string variable = *entry;
    if (!more.contains(variable.substr(0, variable.find('=')))) all.push_back(variable);
  }
  for (const auto& [name, value] : more)
    all.push_back(name + "=" + value);
  return all;
}

}  // namespace

LoggedProcess::LoggedProcess(const std::vector<std::string>& command, const std::filesystem::path& folder,
                             std::filesystem::path log, const std::map<std::string, std::string>& environment)
    : log_(std::move(log)) {
  const auto variables = environment_with(environment);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  const int failed = ::posix_spawn(&pid_, command.front().c_str(), &actions, nullptr,
                                   pointers(command).data(), pointers(variables).data());
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) throw std::runtime_error("cannot start " + command.front());
}

LoggedProcess::~LoggedProcess() {
  if (has_ended()) return;
  ::kill(pid_, SIGKILL);
  ::waitpid(pid_, nullptr, 0);
}

std::string LoggedProcess::output() const {
  return read_file(log_).value_or("");
}

bool LoggedProcess::wait_for(const std::string& text) {
  bool found = false;
  const bool in_time = eventually([&] {
    const bool ended = has_ended();  // first, so that its last words are read
    found = output().find(text) != std::string::npos;
    return found || ended;
  });
  return in_time && found;
}

void LoggedProcess::signal(int number) const {
  if (!status_) ::kill(pid_, number);
}

bool LoggedProcess::has_ended() {
  int status = 0;
  if (!status_ && ::waitpid(pid_, &status, WNOHANG) == pid_) {
    status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  return status_.has_value();
}

std::optional<int> LoggedProcess::wait() {
  (void)eventually([this] { return has_ended(); });
  return status_;
}

}  // namespace segue::testing
