// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/base/mutex.hpp>
#include <segue/mission/reach.hpp>
#include <segue/mission_script/script_data.hpp>
#include <segue/mission_script/script_memory.hpp>
#include <segue/mission_script/script_messages.hpp>
#include <segue/mission_script/script_objects.hpp>
#include <segue/mission_script/script_process.hpp>
#include <segue/mission_script/script_robot.hpp>

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace segue::mission::detail {

/// An execution that a worker has been given.
struct ScriptExecution {
  std::string path;
  Completer completer;
  Globals globals;
  std::vector<std::string> output_names;
  std::vector<type::Value> outputs;  ///< the defaults
  std::vector<std::pair<std::string, Globals::Key>> locks;
  std::optional<TimePoint> overdue;           ///< once preempted: until when it must end
  std::shared_ptr<ScriptRobot::Use> robot{};  ///< null: it uses none
  std::shared_ptr<ScriptData> data{};  ///< for the thread of the process; null: it does not read the world
  bool is_told_memory = false;         ///< which persistent variables it begins with (ActionCall::memory)
};

/// One Python process, and the thread that communicates with it from the first execution until the process
/// has ended. Public functions may be called from any thread; they only queue messages and never block,
/// except the destructor.
class ScriptWorker {
 public:
  explicit ScriptWorker(ScriptOptions options);
  /// Ends the process as ~ScriptRunner does.
  ~ScriptWorker();
  ScriptWorker(const ScriptWorker&) = delete;
  ScriptWorker& operator=(const ScriptWorker&) = delete;

  /// False, without effect, if it accepts no more executions; a new worker always does. `message` has its
  /// length prefix. Throws std::system_error if no thread can be created.
  bool begin(std::uint64_t id, ScriptExecution& execution, const std::string& message);
  /// No effect if the execution is not in this worker, or no longer.
  void preempt(std::uint64_t id);
  void pause(bool paused);

  [[nodiscard]] bool takes_more() const;
  /// The process has ended and its thread is about to return: this can be destroyed without waiting. Set
  /// last, and only tells when to destroy: no data is read on the strength of it, so its order does not
  /// matter.
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
  void show_objects(const type::Value& message);
  void handle_question(const type::Value& message);
  void ask_robot(const std::shared_ptr<ScriptRobot::Use>& robot, const type::Value& message);
  void answer(type::ValueMap answer, std::uint64_t number);
  static void complete(ScriptExecution execution, Ending ending);
  /// Ends or kills the process if it is time to.
  void check_time(const ScriptProcess& process);
  void retire_overdue(TimePoint now) SEGUE_REQUIRES(mutex_);
  [[nodiscard]] std::optional<TimePoint> next_deadline() const;
  void refuse(const std::string& reason);
  void kill_at(TimePoint when, const std::string& reason);
  [[nodiscard]] std::string end_text(const std::string& how) const;
  void abort_all(const std::string& error);
  void forget_released() SEGUE_REQUIRES(mutex_);
  void enqueue(const type::Value& message) SEGUE_REQUIRES(mutex_);
  void enqueue_text(std::string_view text) SEGUE_REQUIRES(mutex_);

  const ScriptOptions options_;
  const std::shared_ptr<Reach<ScriptWorker>> reach_ = std::make_shared<Reach<ScriptWorker>>(*this);
  const std::shared_ptr<ScriptMemory> memory_ = std::make_shared<ScriptMemory>();
  const std::shared_ptr<ScriptObjects> objects_ = std::make_shared<ScriptObjects>();
  Descriptor wake_;
  std::atomic<bool> ended_{false};

  mutable Mutex mutex_;  ///< guards what names it
  std::map<std::uint64_t, ScriptExecution> executions_ SEGUE_GUARDED_BY(mutex_);
  std::string outgoing_ SEGUE_GUARDED_BY(mutex_);
  std::size_t sent_ SEGUE_GUARDED_BY(mutex_) = 0;  ///< of `outgoing_`
  bool open_ SEGUE_GUARDED_BY(mutex_) = true;      ///< accepts executions
  bool closing_ SEGUE_GUARDED_BY(mutex_) = false;
  pid_t pid_ SEGUE_GUARDED_BY(mutex_) = 0;

  // Used only by the thread of the process, but for `thread_` itself.
  MessageReader messages_;
  LineReader lines_;
  std::string last_line_;
  std::optional<TimePoint> kill_at_;
  std::string kill_reason_;
  TimePoint checked_{};
  bool broken_ = false;
  bool asked_to_end_ = false;
  bool killed_ = false;
  std::thread thread_;
};

}  // namespace segue::mission::detail
