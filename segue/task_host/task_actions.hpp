// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/transition.hpp>
#include <segue/task_host/abandoned_tasks.hpp>
#include <segue/task_host/task_connections.hpp>
#include <segue/task_host/task_events.hpp>
#include <segue/task_host/task_maker.hpp>
#include <segue/task_host/task_table.hpp>
#include <segue/task_host/verb_watch.hpp>
#include <segue/task_host/watches.hpp>

namespace segue::task_host::detail {

/// Carries out the eleven actions on the tasks of a table. Thread safe; hooks run without any lock of the
/// table.
class TaskActions {
 public:
  /// `watches`: ring at each change of a task's state.
  TaskActions(TaskTable& table, TaskMaker& maker, TaskConnections& connections, TaskEvents& events,
              Watches& watches)
      : table_(table), maker_(maker), connections_(connections), events_(events), watches_(watches) {}

  Result<void> perform(const model::Action& action, TimePoint deadline);
  void conclude(const model::Transition& transition);
  Result<std::optional<task::SavedState>> save_state(const model::TaskId& id, TimePoint deadline);
  Result<void> restore_state(const model::TaskId& id, const task::SavedState& state, TimePoint deadline);
  Result<void> set_property(const model::TaskId& id, std::string_view path, const type::Value& value,
                            TimePoint deadline);
  Result<type::Value> call(const model::TaskId& id, std::string_view operation, const type::Value& arguments,
                           TimePoint deadline);
  /// Tasks with a hook, an update or an operation that has not returned by its deadline, and which it is.
  [[nodiscard]] std::map<model::TaskId, std::string> hanging();
  /// Whether nothing that hangs keeps a task of this host, removed ones included.
  [[nodiscard]] bool at_rest() { return abandoned_.empty() && hanging().empty(); }

 private:
  Result<void> perform_on_task(model::ActionKind kind, const model::TaskId& id, TimePoint deadline);
  Result<void> hand_over(const model::HandOverAction& what, TimePoint deadline);
  Result<void> run_verb(model::ActionKind kind, const TaskEntry& entry, TimePoint deadline);
  Result<void> deploy(const model::Deployment& deployment);
  /// `kill`: whatever the state of its tasks, which are destroyed.
  Result<void> undeploy(const model::DeploymentKey& key, bool kill);
  Result<void> apply_config(const model::ConfigAction& action, TimePoint deadline);
  Result<void> create(const model::ConfigAction& action, const ProcessEntry* process, TimePoint deadline);
  Result<void> reapply(TaskEntry entry, const model::ConfigAction& action, const ProcessEntry* process,
                       TimePoint deadline);
  /// Replaces the task in the table and in the entry.
  Result<void> renew(TaskEntry& entry, const Activity& activity, const ProcessEntry* process,
                     TimePoint deadline);
  Result<void> check_devices(const TaskEntry& entry) const;
  void listen_to(const TaskEntry& entry);

  TaskTable& table_;
  TaskMaker& maker_;
  TaskConnections& connections_;
  TaskEvents& events_;
  Watches& watches_;
  VerbWatch verbs_;
  AbandonedTasks abandoned_;
};

}  // namespace segue::task_host::detail
