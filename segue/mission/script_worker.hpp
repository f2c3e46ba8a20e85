// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/mission/script_messages.hpp>
#include <segue/mission/script_process.hpp>

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace segue::mission::detail {

/// An execution in a worker, as the engine's side knows it.
struct ScriptExecution {
  std::string path;
  Completer completer;
  Globals globals;
  std::vector<std::string> output_names;
  std::vector<type::Value> outputs;  ///< the defaults
  std::vector<std::pair<std::string, Globals::Key>> locks;
  std::optional<TimePoint> overdue;  ///< once preempted: when its patience is over
};

/// One Python process and the thread that talks with it, from the first execution to its end. Any thread.
class ScriptWorker {
 public:
  explicit ScriptWorker(ScriptOptions options);
  /// Ends the process, as ~ScriptRunner says.
  ~ScriptWorker();
  ScriptWorker(const ScriptWorker&) = delete;
  ScriptWorker& operator=(const ScriptWorker&) = delete;

  /// False where it takes no more executions, and nothing has happened; a fresh one always does. `message` is
  /// a framed one. Throws std::system_error where the system has no thread left.
  bool begin(std::uint64_t id, ScriptExecution& execution, const std::string& message);
  /// Nothing where that is not, or no more, executed here.
  void preempt(std::uint64_t id);
  void pause(bool paused);

  [[nodiscard]] bool takes_more() const;
  /// The process is gone, and all that is left to do is to destroy this.
  [[nodiscard]] bool ended() const { return ended_; }
  [[nodiscard]] std::optional<pid_t> process() const;

 private:
  void run();
  void serve(ScriptProcess& process);
  void flush(const ScriptProcess& process);
  bool read_messages(ScriptProcess& process);
  bool read_output(ScriptProcess& process);
  void handle(const type::Value& message);
  void handle_end(const type::Value& message);
  void handle_question(const type::Value& message);
  /// Ends or kills the process where it is time.
  void check_time(const ScriptProcess& process);
  void retire_overdue(TimePoint now);
  [[nodiscard]] std::optional<TimePoint> next_deadline() const;
  void refuse(const std::string& reason);
  void kill_at(TimePoint when, const std::string& reason);
  [[nodiscard]] std::string told_of_end(const std::string& how) const;
  void abort_all(const std::string& error);
  void enqueue(const type::Value& message);
  void enqueue_text(std::string_view text);

  const ScriptOptions options_;
  Descriptor wake_;
  std::atomic<bool> ended_{false};

  mutable std::mutex mutex_;  ///< guards what follows up to the blank line
  std::map<std::uint64_t, ScriptExecution> executions_;
  std::string outgoing_;
  std::size_t sent_ = 0;  ///< of `outgoing_`
  bool open_ = true;      ///< takes executions
  bool closing_ = false;
  pid_t pid_ = 0;

  // Of the thread alone.
  MessageReader messages_;
  LineReader lines_;
  std::string last_line_;
  std::optional<TimePoint> kill_at_;
  std::string kill_reason_;
  TimePoint checked_{};
  bool broken_ = false;
  bool told_to_end_ = false;
  bool killed_ = false;
  std::thread thread_;
};

}  // namespace segue::mission::detail
