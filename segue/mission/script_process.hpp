// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>
#include <segue/mission/script_runner.hpp>

#include <sys/types.h>

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace segue::mission::detail {

/// A Python interpreter with the worker script, as a child in a process group of its own. It is killed, with
/// its group, where this goes first. One thread, which must outlive the child: the system ends the child with
/// the thread that started it.
class ScriptProcess {
 public:
  /// NotFound, or why the system could not start it. Blocks while it is started.
  static Result<ScriptProcess> start(const ScriptOptions& options);
  ~ScriptProcess();
  ScriptProcess(ScriptProcess&&) noexcept = default;
  ScriptProcess& operator=(ScriptProcess&&) = delete;

  [[nodiscard]] pid_t pid() const { return pid_; }

  struct Events {
    bool messages = false;  ///< something to read, or its end
    bool output = false;
    bool ended = false;  ///< the process has
  };
  /// Blocks until there is something, or something can be sent, or `wake` is readable, or `until` of real
  /// time.
  [[nodiscard]] Events wait(int wake, bool sending, std::optional<TimePoint> until) const;

  enum class Read { Some, Nothing, End };
  /// What is there, up to the size of `buffer`; `text` becomes what was read. Never blocks.
  Read read_messages(std::span<char> buffer, std::string_view& text);
  Read read_output(std::span<char> buffer, std::string_view& text);
  /// How much could be sent; 0 also where nobody reads any more. Never blocks.
  [[nodiscard]] std::size_t send(std::string_view text) const;
  /// Tells it that nothing will come any more: it ends.
  void end_messages() const;

  /// It and all processes that it has begun.
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
  Pid pid_;  ///< 0 once it is reaped
  Descriptor ended_;
  Descriptor messages_;
  Descriptor output_;
};

}  // namespace segue::mission::detail
