// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/base/wait.hpp>
#include <segue/model/ids.hpp>
#include <segue/task/saved_state.hpp>
#include <segue/task_host/completion.hpp>
#include <segue/task_host/port_reader.hpp>
#include <segue/task_host/reports.hpp>
#include <segue/task_host/task_level.hpp>
#include <segue/type/value.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace segue::model {
struct Action;
struct ComponentModel;
}  // namespace segue::model

namespace segue::task_host {

/// Access to the tasks of one place: of a process, of all processes of a robot on a host, or of all hosts of
/// a robot. Functions may be called from any thread. Those with a deadline block until then at most, the
/// others return quickly; a client (control/) answers Unavailable where the other side is gone and
/// DeadlineExceeded where it does not answer.
class TaskAccess {
 public:
  virtual ~TaskAccess() = default;

  /// Begins to carry out actions that do not depend on each other, at the same time, and returns without
  /// waiting for hooks. A failure does not keep the others from being carried out. Each action is reported
  /// exactly once: what ends quickly together is reported together, what ends while others still run without
  /// waiting for them, and what has not ended shortly after `deadline` as DeadlineExceeded; it may still be
  /// at work. Where this is destroyed before all are reported, its destructor waits for them or reports them
  /// as Unavailable.
  virtual void begin_all(std::vector<model::Action> actions, TimePoint deadline, Completion completed) = 0;
  /// Carries out actions like begin_all() and waits until all are reported; outcomes in the order of
  /// `actions`.
  std::vector<Result<void>> perform_all(std::span<const model::Action> actions, Deadline deadline);

  /// The halves of a hand-over whose other half is at another place: save_state() reads the state of a
  /// Stopped task (nothing where its component has none), restore_state() gives it to a task that is
  /// configured and does not run. While a task moves, the first means its current incarnation, the second its
  /// next one.
  virtual Result<std::optional<task::SavedState>> save_state(const model::TaskId& task,
                                                             TimePoint deadline) = 0;
  virtual Result<void> restore_state(const model::TaskId& task, const task::SavedState& state,
                                     TimePoint deadline) = 0;

  /// The current interface of a task, including its dynamic ports.
  virtual Result<model::ComponentModel> describe(const model::TaskId& task) const = 0;
  virtual Result<type::Value> properties(const model::TaskId& task) const = 0;
  virtual Result<TaskDetails> details(const model::TaskId& task) const = 0;  ///< Unsupported: older Segue
  /// Has `answered` called with how the task is, once that is not as `question.seen` says; or, at the
  /// deadline, as it is then. Only where the task lives is asked. Returns at once. NotFound, also where the
  /// task is removed meanwhile; Unavailable where its process is gone; DeadlineExceeded where that does not
  /// answer.
  virtual void watch(const LevelQuestion& question, const Wait& wait, LevelAnswer answered) = 0;
  virtual Result<void> set_property(const model::TaskId& task, std::string_view path,
                                    const type::Value& value, TimePoint deadline) = 0;
  virtual Result<type::Value> call(const model::TaskId& task, std::string_view operation,
                                   const type::Value& arguments, TimePoint deadline) = 0;
  /// With room for `buffer` samples; kMeasureWrites: measurements instead.
  virtual Result<std::unique_ptr<PortReader>> open_reader(const model::PortRef& port, std::size_t buffer) = 0;
  /// Writes a sample to an input port, as a connection of its own would, and waits until the task has taken
  /// it. NotFound, with the task's input ports; TypeMismatch; InvalidState where the task does not run;
  /// DeadlineExceeded where it has not taken the sample, which is then withdrawn.
  virtual Result<void> write(const model::PortRef& port, const type::Value& value, TimePoint deadline) = 0;
};

}  // namespace segue::task_host
