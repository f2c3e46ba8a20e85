// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "logged_process.hpp"

namespace segue::testing {

/// Where a host is, if it is not just a folder of this computer.
struct Surroundings {
  std::vector<std::string> launcher;  ///< what starts its daemon, whose command follows
  std::vector<std::string> options;   ///< of the daemon
  std::map<std::string, std::string> environment;
  std::string address;      ///< empty: its Unix socket
  std::string credentials;  ///< of those who command it
};

/// A host of a robot in a test: a daemon of its own (`segue host`) on this computer, with its own folders for
/// sockets and for what outlives it. The destructor kills everything that still runs there.
class TestHost {
 public:
  /// Below `folder`, which should have a short path, since those of sockets are limited.
  TestHost(std::string name, const std::filesystem::path& folder, Surroundings surroundings = {});
  ~TestHost();
  TestHost(const TestHost&) = delete;
  TestHost& operator=(const TestHost&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::filesystem::path runtime_folder() const { return folder_ / "r"; }
  [[nodiscard]] std::filesystem::path state_folder() const { return folder_ / "state"; }
  [[nodiscard]] std::string address() const;
  [[nodiscard]] const std::string& credentials() const { return surroundings_.credentials; }
  /// What its daemons have written.
  [[nodiscard]] std::string output() const { return daemon_ == nullptr ? "" : daemon_->output(); }

  /// Starts the daemon and waits until it can be reached.
  void start();
  /// Ends the daemon cleanly; deployments stay.
  void stop();
  /// As if the computer lost its power: the daemon and all deployments, at once.
  void kill();
  /// As if it was started again after that: what it kept in its runtime folder is gone, too.
  void reboot();
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
  const Surroundings surroundings_;
  std::unique_ptr<LoggedProcess> daemon_;
};

}  // namespace segue::testing
