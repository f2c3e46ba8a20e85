// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <support/eventually.hpp>

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <sys/types.h>

/// Real processes for tests through the command line. Every wait has a deadline.
namespace segue::testing {

/// The result of a finished process. `status` is its exit status, 128 + the signal that ended it, or -1 if it
/// had to be killed at the deadline.
struct Finished {
  int status = -1;
  std::string output;
  std::string errors;
};

/// A process whose output is collected. Killed by the destructor if it still runs.
class Process {
 public:
  /// Starts `command` (a path first) in `folder`.
  explicit Process(const std::vector<std::string>& command, const std::filesystem::path& folder = ".");
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// Waits for a line with `text` on standard output; false at the deadline or the end of the process.
  bool wait_for(const std::string& text);
  /// Waits until all of standard output so far fulfils the condition; false as above.
  [[nodiscard]] bool wait_until(const std::function<bool(const std::string& output)>& condition);
  void signal(int number) const;
  [[nodiscard]] pid_t pid() const { return pid_; }
  /// Waits until the process handles this signal by blocking it; false at the deadline or its end.
  [[nodiscard]] bool wait_until_blocked(int signal) const;
  /// Whether the process has ended, without waiting; wait() still returns how.
  [[nodiscard]] bool has_ended() const;
  /// Nobody reads its standard output any more.
  void close_output();
  /// Waits for the end.
  Finished wait(std::chrono::seconds limit = kPatience);

 private:
  /// Reads available output; false once both ends are closed. Waits at most for `limit`.
  bool pump(std::chrono::milliseconds limit);
  bool read_from(int& descriptor, std::string& into);

  pid_t pid_ = -1;
  int output_ = -1;
  int errors_ = -1;
  Finished finished_;
};

/// Starts a process and waits for its end.
Finished run(const std::vector<std::string>& command, const std::filesystem::path& folder = ".");

struct Terminal {
  unsigned short columns = 100;
  unsigned short rows = 40;
  /// Typed once `typed_after` was written there. Standard input is the terminal unless this is empty.
  std::string typed;
  std::string typed_after;
};

/// The same with its standard output and error on a terminal; all that it writes there is `output`, as it is,
/// with what the terminal echoes.
Finished run_on_terminal(const std::vector<std::string>& command, const std::filesystem::path& folder = ".",
                         const Terminal& kind = {});

}  // namespace segue::testing
