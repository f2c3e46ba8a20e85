// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/task/call_queue.hpp>
#include <segue/task/channel.hpp>
#include <segue/task/component.hpp>
#include <segue/task/executor.hpp>
#include <segue/task/ownership.hpp>
#include <segue/task/progress.hpp>
#include <segue/task/realtime_text.hpp>
#include <segue/task/task.hpp>
#include <segue/task/timing_recorder.hpp>

#include <atomic>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace segue::task {

/// Gives tasks, and nobody else, access to the hooks of a component.
class ComponentAccess {
 public:
  static Result<void> configure(Component& component) { return component.on_configure(); }
  static Result<void> start(Component& component) { return component.on_start(); }
  static Result<void> recover(Component& component) { return component.on_recover(); }
  static void update(Component& component) { component.on_update(); }
  static void error(Component& component) { component.on_error(); }
  static void stop(Component& component) { component.on_stop(); }
  static void cleanup(Component& component) { component.on_cleanup(); }
  static std::optional<SavedState> save_state(Component& component) { return component.save_state(); }
  static Result<void> restore_state(Component& component, const SavedState& state) {
    return component.restore_state(state);
  }
  static void set_context(Component& component, TaskContext* context) { component.context_ = context; }
  static OutputPort<std::int32_t>& state_port(Component& component) { return component.state_port_; }
};

/// A task as a job of its executor. Members without another remark are guarded by `ownership`.
struct Task::Implementation final : Job, TaskContext, SampleListener {
  Implementation(std::string task_id, std::unique_ptr<Component> made, Activity wanted,
                 std::shared_ptr<Executor> runner);
  /// Takes over the component of `old`, which must then be retired.
  Implementation(const Implementation& old, Activity wanted, std::shared_ptr<Executor> runner);
  ~Implementation();

  // TaskContext, for hooks.
  [[nodiscard]] const std::string& id() const override { return name; }
  [[nodiscard]] TimePoint now() const override { return executor->clock().now(); }
  void set_state(std::uint32_t sub_state) override;
  void error(std::uint32_t sub_state, std::string_view text) override;
  void recovered() override;
  void exception(std::string_view text) override;
  void fatal(std::string_view text) override;
  Result<void> trigger_fd(int descriptor, std::string_view descriptor_name) override;

  void sample_arrived() noexcept override { executor->trigger(*this, Job::kSample); }
  [[nodiscard]] Executor& runner() noexcept override { return *executor; }
  TimePoint run(std::uint32_t reasons, TimePoint& now) noexcept override;

  // Life cycle (life_cycle.cpp).
  Result<void> configure();
  Result<void> start();
  Result<void> stop();
  Result<void> cleanup();
  Result<void> recover();
  void shut_down();
  Result<void> save_state(std::optional<SavedState>& state);
  Result<void> restore_state(const SavedState& state);

  /// How far the life cycle has come, which decides the hooks that undo it.
  enum class Reached { Nothing, Configured, Started };
  struct HookEnd {
    std::optional<Error> refused;
    bool broke = false;  ///< threw, or asked for exception or fatal
  };
  template <class Hook>
  HookEnd run_hook(std::string_view hook_name, Hook hook);
  Result<void> collapse(std::string_view hook_name, Reached reached);
  void undo(std::string_view hook_name, void (*hook)(Component&));
  Result<void> refused(std::string_view hook_name, Error why);
  Result<void> arm();
  Result<void> watch_descriptors();
  void disarm();
  void enter(TaskState state, std::uint32_t sub_state = 0);
  [[nodiscard]] Error illegal(std::string_view verb, std::string_view needed) const;

  // Updates (task_update.cpp).
  [[nodiscard]] bool active() const;
  [[nodiscard]] bool is_timed() const;
  [[nodiscard]] bool due(std::uint32_t reasons, TimePoint now) const;
  void update(TimePoint& now) noexcept;
  void announce_update() noexcept;
  [[nodiscard]] TimePoint next_timeout() const noexcept;
  void retrigger_if_pending() noexcept;
  [[nodiscard]] std::uint64_t trigger_samples_read() const noexcept;
  void serve_calls() noexcept;
  void note_operation(TimePoint caller_deadline) noexcept;
  void release() noexcept;

  [[nodiscard]] TaskState state() const {
    return static_cast<TaskState>(state_word.load(std::memory_order_acquire) & 0xFFU);  // pairs with V1
  }
  [[nodiscard]] std::string state_name() const;
  /// Runs `body` while holding the ownership. From any thread; InvalidState inside own hooks,
  /// DeadlineExceeded.
  template <class Body>
  Result<void> exclusive(std::string_view verb, TimePoint deadline, Body body);
  /// The time until which a verb with this deadline waits: shorter where the work in progress is overdue
  /// before.
  [[nodiscard]] TimePoint patience(TimePoint deadline) const;
  [[nodiscard]] Error too_late(std::string_view verb) const;
  [[nodiscard]] std::optional<std::string> overdue() const;
  Result<type::Value> call(std::string_view operation, const type::Value& arguments, TimePoint deadline);
  Result<type::Value> call_in_thread(std::unique_ptr<OperationCall> prepared, const std::string& operation,
                                     TimePoint deadline);

  enum class Request { None, Exception, Fatal };

  // The members that each update uses come first, side by side: an update that finds them in few lines of the
  // cache is quicker.
  const std::shared_ptr<Executor> executor;
  const std::shared_ptr<Component> component;  ///< shared with retired implementations
  detail::Ownership ownership;                 ///< any thread
  /// TaskState in the low byte, above it the index of the sub-state + 1. Any thread reads. V1: changes are
  /// released and reads acquired, so whoever sees a state sees what led to it.
  std::atomic<std::uint32_t> state_word{0};
  std::atomic<bool> announces_update{false};  ///< any thread sets it
  std::uint32_t deferred = 0;                 ///< executor's thread only: reasons of turns that were missed
  std::uint32_t trigger_on_release = 0;       ///< reasons to run when the ownership is released
  Request request = Request::None;
  bool starting = false;
  bool retired = false;       ///< the component has moved to another task
  detail::CallQueue calls;    ///< any thread
  detail::Progress progress;  ///< any thread reads
  std::vector<InputPortBase*> trigger_inputs;
  std::vector<int> descriptors;
  std::set<std::string, std::less<>> given_descriptors;  ///< the names of those of this start
  TimePoint due_at{};
  const Activity activity;
  const Duration update_deadline;
  detail::TimingRecorder recorder;  ///< any thread reads

  detail::RealtimeText message;  ///< any thread reads
  const std::string name;
  Task* task = nullptr;
  /// Guards the properties against concurrent setting and reading from outside; shared along with the
  /// component.
  const std::shared_ptr<Mutex> properties_mutex;
  Task::StateListener listener;
  std::uint32_t error_at_start = 0;  ///< sub-state's index + 2; 0: none
  std::uint32_t state_at_start = 0;  ///< sub-state's index + 1, as on_start entered it; 0: none
};

template <class Body>
Result<void> Task::Implementation::exclusive(std::string_view verb, TimePoint deadline, Body body) {
  if (ownership.is_mine()) {
    return fail(ErrorCode::InvalidState,
                "cannot " + std::string(verb) + " a task from inside its own hook; use another thread", name);
  }
  bool retry = false;
  if (!ownership.acquire(patience(deadline), retry)) {
    if (retry) executor->trigger(*this, Job::kRetry);
    return too_late(verb);
  }
  struct Releaser {
    Implementation& owned;
    ~Releaser() { owned.release(); }
  } const releaser{*this};
  if (retired) {
    return fail(ErrorCode::InvalidState, "the task has been replaced; look it up again", name);
  }
  return body();
}

}  // namespace segue::task
