// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>

#include <spawn.h>
#include <sys/types.h>

#include <string>
#include <utility>
#include <vector>

namespace segue {

/// Starts a program with posix_spawn, which never copies this process, however large it is. The child leads
/// its own process group, has all signals unblocked with default actions, and inherits only the descriptors
/// handed over to it. Not thread safe.
class ChildProcess {
 public:
  /// `first_free`: one more than the highest descriptor number of the child.
  explicit ChildProcess(int first_free);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// The child gets `source` as descriptor `number`, whatever numbers are in use in this process.
  Result<void> hand_over(int source, int number);
  Result<void> open_null(int number);
  /// The child begins in that folder.
  Result<void> set_folder(const std::string& folder);
  /// Adds to, or overrides in, the environment inherited from this process.
  void set_environment(std::vector<std::pair<std::string, std::string>> more) { more_ = std::move(more); }

  /// `words` is argv, starting with the program's name. A program without a slash is searched in PATH. Fails,
  /// leaving no process, where it cannot be executed; the error message calls it `what`.
  Result<pid_t> start(const std::string& program, std::vector<std::string> words,
                      const std::string& what = {});

 private:
  const int first_free_;
  posix_spawn_file_actions_t actions_{};
  posix_spawnattr_t attributes_{};
  std::vector<Descriptor> moved_;
  std::vector<std::pair<std::string, std::string>> more_;
};

/// Blocks until a child has ended, and forgets it; kills it after `patience`.
void wait_for_end(pid_t child, Duration patience);

}  // namespace segue
