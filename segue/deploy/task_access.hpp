// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/model/component_model.hpp>
#include <segue/model/transition.hpp>
#include <segue/task/task.hpp>
#include <segue/task_host/task_host.hpp>
#include <segue/type/value.hpp>

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace segue::deploy {

/// Access to the tasks of one place: of a deployment process, or of all processes of a robot on a host.
/// Functions may be called from any thread and block until their deadline at most. Those without a deadline
/// return quickly; a client (control/) answers Unavailable where the other side is gone and DeadlineExceeded
/// where it does not answer.
class TaskAccess {
 public:
  virtual ~TaskAccess() = default;

  /// Begins to carry out actions at this place that do not depend on each other, and returns without waiting
  /// for hooks; `completed` as TaskHost::begin_all says. Where this is destroyed before all are reported, its
  /// destructor waits for them or reports them as Unavailable.
  virtual void begin_all(std::vector<model::Action> actions, TimePoint deadline,
                         task_host::Completion completed) = 0;
  /// Carries out actions as begin_all() does and waits for all; outcomes in the order of `actions`.
  std::vector<Result<void>> perform(std::span<const model::Action> actions, TimePoint deadline);

  /// Transfer a task's state to a task of another place: save_state() reads it from a Stopped task (nothing
  /// where its component has no state), restore_state() gives it to a task that is configured and does not
  /// run.
  virtual Result<std::optional<task::SavedState>> save_state(const model::TaskId& task,
                                                             TimePoint deadline) = 0;
  virtual Result<void> restore_state(const model::TaskId& task, const task::SavedState& state,
                                     TimePoint deadline) = 0;

  virtual Result<model::ComponentModel> describe(const model::TaskId& task) = 0;
  virtual Result<type::Value> properties(const model::TaskId& task) = 0;
  /// Has `answered` called once the task's level differs from `question.seen`, or at the deadline; see
  /// TaskHost::watch(). Returns at once.
  virtual void watch(const task_host::LevelQuestion& question, const Wait& wait,
                     task_host::LevelAnswer answered) = 0;
  virtual Result<task_host::TaskDetails> details(
      const model::TaskId& task) = 0;  ///< Unsupported: older Segue
  virtual Result<void> set_property(const model::TaskId& task, std::string_view path,
                                    const type::Value& value, TimePoint deadline) = 0;
  virtual Result<type::Value> call(const model::TaskId& task, std::string_view operation,
                                   const type::Value& arguments, TimePoint deadline) = 0;
  virtual Result<std::unique_ptr<task_host::PortReader>> open_reader(const model::PortRef& port,
                                                                     std::size_t buffer) = 0;
  virtual Result<void> write(const model::PortRef& port, const type::Value& value, TimePoint deadline) = 0;
};

}  // namespace segue::deploy
