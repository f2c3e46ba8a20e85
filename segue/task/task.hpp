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

/// Owns a component, takes it through its life cycle, and runs its updates on an Executor.
///
/// Life-cycle functions may be called from any thread; they exclude each other and the update. Hooks run in
/// the caller's thread; on_update and operations with RunsIn::TaskThread run on the executor's. Each waits
/// until `deadline` for an update in progress, then fails with DeadlineExceeded and leaves the task
/// unchanged. A hook that throws leads to Exception; a hook that returns an error keeps the previous state
/// (HookFailed). InvalidState where the state does not allow the change, and for calls from one of the task's
/// own hooks. Deadlines, such as `10s` from now on, are real time, whatever clock the executor has. No
/// function but the destructor waits for an update or an operation that is overdue().
class Task {
 public:
  /// Uses the component's default activity where `activity` is null. Creates the thread; tasks that name the
  /// same thread group share one (ExecutorSet::of_process).
  static Result<std::unique_ptr<Task>> create(std::string id, std::unique_ptr<Component> component,
                                              const Activity* activity = nullptr);
  /// Makes a task on a given executor, for tests.
  static Result<std::unique_ptr<Task>> create(std::string id, std::unique_ptr<Component> component,
                                              const Activity& activity, std::shared_ptr<Executor> executor);
  /// Moves the component of a task in PreOperational to a new task with another activity and executor; its
  /// ports keep their connections. Calls of `old` fail with InvalidState from then on.
  static Result<std::unique_ptr<Task>> renew(Task& old, const Activity& activity,
                                             std::shared_ptr<Executor> executor, Deadline deadline);
  /// Stops and cleans up if need be; disconnects every port. Waits for an update in progress without a
  /// deadline; must not be called from inside one of the task's hooks.
  ~Task();
  Task(const Task&) = delete;
  Task& operator=(const Task&) = delete;

  [[nodiscard]] const std::string& id() const;
  [[nodiscard]] Component& component();
  [[nodiscard]] const Component& component() const;

  Result<void> configure(Deadline deadline);  ///< PreOperational -> Stopped
  Result<void> start(Deadline deadline);      ///< Stopped -> Running
  Result<void> stop(Deadline deadline);       ///< Running, RunTimeError -> Stopped
  Result<void> cleanup(Deadline deadline);    ///< Stopped -> PreOperational
  /// RunTimeError -> Running; Exception -> PreOperational.
  Result<void> recover(Deadline deadline);

  /// The state of the component, for the task that takes over from this one; nothing if it has none. Requires
  /// Stopped, which does not change, even if the hook throws (HookFailed).
  Result<std::optional<SavedState>> save_state(Deadline deadline);
  /// Takes over another task's state. Requires Stopped, which stays where the component refuses the state; an
  /// exception leads to Exception.
  Result<void> restore_state(const SavedState& state, Deadline deadline);

  /// Waits until no hook or update is in progress; DeadlineExceeded if one does not return in time.
  Result<void> settle(Deadline deadline);

  /// Lock free.
  [[nodiscard]] TaskState state() const;
  /// The named sub-state, or the state's own name.
  [[nodiscard]] std::string state_name() const;
  /// Why the task is in error, as its hook said; empty without one.
  [[nodiscard]] std::string error_message() const;

  /// Sets the properties named in the map `values`. Fields of compounds that are not named keep their values;
  /// any other value is replaced as a whole. Atomic: every value is checked first. Once configured, only live
  /// properties may be set.
  Result<void> set_properties(const type::Value& values, Deadline deadline);
  [[nodiscard]] type::Value properties() const;
  /// Lets `add` add properties to the component while nobody reads or sets them through this task; the caller
  /// must keep others away from them. Requires PreOperational.
  Result<void> extend(const std::function<void(Component&)>& add, Deadline deadline);

  /// Calls an operation with arguments by name (a map) or in order (a list). Waits until `deadline` for
  /// operations that run in the task's own thread; one that has not begun by then never will.
  Result<type::Value> call(std::string_view operation, const type::Value& arguments, Deadline deadline);

  [[nodiscard]] const Activity& activity() const;
  [[nodiscard]] Timing timing() const;
  [[nodiscard]] TimingHistograms timing_histograms() const;
  /// The call in the task's thread that exceeds its deadline (deadline_of() the activity; an operation also
  /// has that of its call): "on_update has not returned within 5 s". Nothing if none does.
  [[nodiscard]] std::optional<std::string> overdue() const;

  /// Called after every change of state or sub-state, and where announce_next_update() has asked for it, in
  /// the thread that caused it. Must not block or call the task.
  using StateListener = std::function<void(const Task& task, TaskState state)>;
  void set_state_listener(StateListener listener);
  /// The listener is to be called, once, after the next turn of the task's thread, which updates the task or
  /// serves operations. Lock free. A turn that ends at this very moment may not be told, since each turn
  /// would have to pay for a barrier; the next one is. Whoever needs to know of the last one, too, looks
  /// at the count of updates again after a while.
  void announce_next_update();

  struct Implementation;

 private:
  explicit Task(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::task
