// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace segue::testing {

/// A process that writes all its output to a file, so that nobody has to read it while it runs. Killed by the
/// destructor if it still runs. Every wait has a deadline.
class LoggedProcess {
 public:
  /// Starts `command` (a path first) in `folder`, with these variables besides those of the test.
  LoggedProcess(const std::vector<std::string>& command, const std::filesystem::path& folder,
                std::filesystem::path log, const std::map<std::string, std::string>& environment = {});
  ~LoggedProcess();
  LoggedProcess(const LoggedProcess&) = delete;
  LoggedProcess& operator=(const LoggedProcess&) = delete;

  [[nodiscard]] pid_t pid() const { return pid_; }
  /// What it has written so far.
  [[nodiscard]] std::string output() const;
  /// Waits until it has written `text`; false at the deadline or at the end of the process.
  [[nodiscard]] bool wait_for(const std::string& text);
  void signal(int number) const;
  /// Waits for its end: the exit status, or 128 + the signal that ended it; nothing at the deadline.
  std::optional<int> wait();

 private:
  [[nodiscard]] bool has_ended();

  const std::filesystem::path log_;
  pid_t pid_ = -1;
  std::optional<int> status_;
};

}  // namespace segue::testing
