// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/activity.hpp>
#include <segue/base/clock.hpp>
#include <segue/base/life_cycle.hpp>
#include <segue/base/result.hpp>
#include <segue/task/component.hpp>
#include <segue/task/executor.hpp>
#include <segue/task/timing.hpp>
#include <segue/type/value.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::task {

/// A component brought to life: owns it, walks it through its life cycle, and runs its updates on an
/// Executor.
///
/// Life-cycle verbs may be called from any thread; they exclude each other and the update. Hooks run in the
/// caller's thread, on_update and operations of the own thread on the executor's. A verb waits for an update
/// in progress until `deadline`, and then answers DeadlineExceeded with the task unchanged. A hook that
/// throws leads to Exception; a hook that returns an error leaves the state before the verb (HookFailed).
/// Illegal verbs answer InvalidState and name the state, as does a verb called from inside one of the task's
/// own hooks. Deadlines are real time, whatever clock the executor has.
class Task {
 public:
  /// The component's default activity is used where `activity` is null. The thread is created here.
  /// Tasks that name the same thread group share one (ExecutorSet::of_process).
  static Result<std::unique_ptr<Task>> create(std::string id, std::unique_ptr<Component> component,
                                              const Activity* activity = nullptr);
  /// As above on a given executor (thread groups, tests).
  static Result<std::unique_ptr<Task>> create(std::string id, std::unique_ptr<Component> component,
                                              const Activity& activity, std::shared_ptr<Executor> executor);
  /// The same component in PreOperational as a task with another activity, on another executor: its ports
  /// keep their connections. `old` answers InvalidState from then on.
  static Result<std::unique_ptr<Task>> renew(Task& old, const Activity& activity,
                                             std::shared_ptr<Executor> executor, TimePoint deadline);
  /// Stops and cleans up if need be; disconnects every port. Waits for an update in progress without a
  /// deadline; must not be called from inside one of the task's hooks.
  ~Task();
  Task(const Task&) = delete;
  Task& operator=(const Task&) = delete;

  [[nodiscard]] const std::string& id() const;
  [[nodiscard]] Component& component();
  [[nodiscard]] const Component& component() const;

  Result<void> configure(TimePoint deadline);  ///< PreOperational -> Stopped
  Result<void> start(TimePoint deadline);      ///< Stopped -> Running
  Result<void> stop(TimePoint deadline);       ///< Running, RunTimeError -> Stopped
  Result<void> cleanup(TimePoint deadline);    ///< Stopped -> PreOperational
  /// RunTimeError -> Running; Exception -> PreOperational.
  Result<void> recover(TimePoint deadline);

  /// What the component remembers, for the task that takes over from this one; nothing if it has no state.
  /// While Stopped, and stays so, even where the hook throws (HookFailed).
  Result<std::optional<State>> save_state(TimePoint deadline);
  /// Continues another's state; while Stopped. Where the component refuses it the task stays Stopped, where
  /// it throws Exception follows.
  Result<void> restore_state(const State& state, TimePoint deadline);

  /// Waits until no hook or update is in progress; DeadlineExceeded where one does not return.
  Result<void> settle(TimePoint deadline);

  /// Lock free.
  [[nodiscard]] TaskState state() const;
  /// The named sub-state, or the state's own name.
  [[nodiscard]] std::string state_name() const;
  /// Why the task is in error, as its hook said; empty without one.
  [[nodiscard]] std::string error_message() const;

  /// Properties to these values (a map, in part or whole); those that are not named stay, and so do the
  /// fields of a compound; any other value is replaced as a whole. All or nothing: every value is checked
  /// first. In Running and Stopped only live properties may be set; in PreOperational all.
  Result<void> set_properties(const type::Value& values, TimePoint deadline);
  [[nodiscard]] type::Value properties() const;
  /// In PreOperational: lets `add` give the component more properties, while nobody reads or sets them
  /// through this. Others who look at its properties must be kept away by the caller.
  Result<void> extend(const std::function<void(Component&)>& add, TimePoint deadline);

  /// Calls an operation with named arguments (a map) or a list in order. Waits until `deadline` for
  /// operations that run in the task's own thread; one that has not begun by then never will.
  Result<type::Value> call(std::string_view operation, const type::Value& arguments, TimePoint deadline);

  [[nodiscard]] const Activity& activity() const;
  [[nodiscard]] Timing timing() const;

  /// Called after every change of state or sub-state, from the thread that made it; must not block nor call
  /// back.
  using StateListener = std::function<void(const Task& task, TaskState state)>;
  void set_state_listener(StateListener listener);

  struct Implementation;

 private:
  explicit Task(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::task
