// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>

#include <spawn.h>
#include <sys/types.h>

#include <string>
#include <utility>
#include <vector>

namespace segue {

/// A program that is to become a process of its own, by posix_spawn: never a copy of this process, however
/// large that is. The child leads a process group of its own, with all signals unblocked and at their
/// defaults, and has the descriptors that it is given and no others. One thread.
class ChildProcess {
 public:
  /// `first_free`: one more than the highest number that a descriptor will have in the child.
  explicit ChildProcess(int first_free);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// The child has `source` as `number`, whatever other numbers are in use here.
  Result<void> hand_over(int source, int number);
  Result<void> open_null(int number);
  /// Added to the environment of this process, or in place of what is there.
  void set_environment(std::vector<std::pair<std::string, std::string>> more) { more_ = std::move(more); }

  /// `words` begin with what the program sees as its name. A program without a slash is looked for in PATH.
  /// Fails, with no process left, where it cannot be executed; the error calls it `what`.
  Result<pid_t> start(const std::string& program, std::vector<std::string> words,
                      const std::string& what = {});

 private:
  const int first_free_;
  posix_spawn_file_actions_t actions_{};
  posix_spawnattr_t attributes_{};
  std::vector<Descriptor> moved_;
  std::vector<std::pair<std::string, std::string>> more_;
};

}  // namespace segue
