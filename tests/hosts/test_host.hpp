// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "logged_process.hpp"

namespace segue::testing {

/// A host of a robot in a test: a daemon of its own (`segue host`) on this computer, with its own folders for
/// sockets and for what outlives it. The destructor kills everything that still runs there.
class TestHost {
 public:
  /// Below `folder`, which should have a short path, since those of sockets are limited.
  TestHost(std::string name, const std::filesystem::path& folder);
  ~TestHost();
  TestHost(const TestHost&) = delete;
  TestHost& operator=(const TestHost&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::filesystem::path runtime_folder() const { return folder_ / "r"; }
  [[nodiscard]] std::string address() const;
  /// What its daemons have written.
  [[nodiscard]] std::string output() const { return daemon_ == nullptr ? "" : daemon_->output(); }

  /// Starts the daemon and waits until it can be reached.
  void start();
  /// Ends the daemon cleanly; deployments stay.
  void stop();
  /// As if the computer lost its power: the daemon and all deployments, at once.
  void kill();
  /// The daemon, and what it starts processes with; deployments stay.
  void kill_daemon();
  /// All processes stand still until thaw(), so that whatever is asked of them gets no answer.
  void freeze();
  void thaw();

  /// Its deployment processes, by name, with that of connections between hosts.
  [[nodiscard]] std::map<std::string, pid_t> deployments() const;

 private:
  void signal_all(int number) const;

  const std::string name_;
  const std::filesystem::path folder_;
  std::unique_ptr<LoggedProcess> daemon_;
};

}  // namespace segue::testing
