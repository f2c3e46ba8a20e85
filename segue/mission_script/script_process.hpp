// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>
#include <segue/mission_script/script_runner.hpp>

#include <sys/types.h>

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace segue::mission::detail {

/// NotFound if the interpreter or the worker script is not there. Does not block; any thread.
Result<void> check_python(const ScriptOptions& options);

/// A child process that runs the worker script, in its own process group, which the destructor kills. For one
/// thread, which must outlive the child: the kernel kills the child together with the thread that started it.
class ScriptProcess {
 public:
  /// NotFound, or the error of the system. Blocks while the process is started.
  static Result<ScriptProcess> start(const ScriptOptions& options);
  ~ScriptProcess();
  ScriptProcess(ScriptProcess&&) noexcept = default;
  ScriptProcess& operator=(ScriptProcess&&) = delete;

  [[nodiscard]] pid_t pid() const { return pid_; }

  struct Events {
    bool messages = false;  ///< there is something to read, or the stream has ended
    bool output = false;
    bool ended = false;  ///< the process has ended
  };
  /// Blocks until one of these events has happened, or `sending` and data can be sent, or `wake` is readable,
  /// or until `until` in real time.
  [[nodiscard]] Events wait(int wake, bool sending, std::optional<TimePoint> until) const;

  enum class Read { Some, Nothing, End };
  /// Reads what is available into `buffer`; `text` is the part of it that was filled. Never blocks.
  Read read_messages(std::span<char> buffer, std::string_view& text);
  Read read_output(std::span<char> buffer, std::string_view& text);
  /// Returns how much was sent; 0 also if the reader is gone. Never blocks.
  [[nodiscard]] std::size_t send(std::string_view text) const;
  /// Closes the stream of messages, upon which the process ends.
  void end_messages() const;

  /// Kills the process and its descendants, those in other process groups and sessions too.
  void kill() const;
  /// "was killed by signal 9 (Killed)", "ended with exit status 3". Requires that it has ended.
  std::string reap();

 private:
  ScriptProcess() = default;

  struct Pid {
    pid_t value = 0;
    explicit Pid(pid_t pid = 0) : value(pid) {}
    Pid(Pid&& other) noexcept : value(std::exchange(other.value, 0)) {}
    Pid& operator=(Pid&& other) noexcept {
      value = std::exchange(other.value, 0);
      return *this;
    }
    operator pid_t() const { return value; }  // NOLINT(google-explicit-constructor)
  };
  Pid pid_;           ///< 0 after reap()
  std::string mark_;  ///< in the environment of the process and its descendants
  Descriptor ended_;
  Descriptor messages_;
  Descriptor output_;
};

}  // namespace segue::mission::detail
