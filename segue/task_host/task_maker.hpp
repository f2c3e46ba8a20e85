// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/task_host/component_library.hpp>
#include <segue/task_host/local_task_host.hpp>
#include <segue/task_host/stand_in.hpp>
#include <segue/task_host/task_table.hpp>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace segue::task_host::detail {

/// Creates tasks from their definitions: components of libraries, or stand-ins, on the threads of their
/// process. Thread safe.
class TaskMaker {
 public:
  TaskMaker(const LibrarySet& libraries, const model::ComponentCatalog& catalog, LocalOptions options)
      : libraries_(libraries), catalog_(catalog), options_(std::move(options)) {}

  /// Whether tasks of the component are stand-ins (TaskHost::stands_in()), or may be, since its model is not
  /// known.
  [[nodiscard]] bool is_unchecked(const model::ComponentName& component) const;
  Result<void> can_make(const model::ComponentName& component) const;
  /// Stand-ins made from now on have the ports that `network` names.
  void expect(const model::Network& network);

  /// A task in PreOperational without its properties. `process` is nullptr for the runtime's own.
  Result<TaskEntry> make(const model::Task& definition, const ProcessEntry* process) const;

  /// Moves the task of `entry` to another thread; its component stays, with its ports and their connections.
  [[nodiscard]] Result<std::shared_ptr<task::Task>> renew(const TaskEntry& entry, const Activity& activity,
                                                          const ProcessEntry* process,
                                                          TimePoint deadline) const;
  /// Gives a stand-in the properties that `definition` names and that it lacks.
  static Result<void> complete(const TaskEntry& entry, const model::Task& definition, TimePoint deadline);

  /// The activity of the task: as the network specifies it, else the component, else the process.
  [[nodiscard]] Activity activity_for(const model::Task& definition, const ProcessEntry* process,
                                      const task::Component& component, bool stand_in) const;
  /// The problem of the configuration of the behaviour of the task's stand-in; nothing if it is valid.
  [[nodiscard]] std::optional<std::string> problem_of_behaviour(const model::Task& definition) const;
  /// How a task's stand-in behaves now.
  [[nodiscard]] StandInBehaviour behaviour_of(const model::Task& definition) const;

 private:
  [[nodiscard]] static Result<std::shared_ptr<task::Executor>> executor_for(const model::TaskId& task,
                                                                            const Activity& activity,
                                                                            const ProcessEntry* process);
  [[nodiscard]] bool stands_in(const model::ComponentName& component) const;
  Result<std::unique_ptr<task::Component>> make_component(const model::Task& definition, bool stand_in) const;
  [[nodiscard]] std::unique_ptr<task::Component> make_stand_in_for(const model::Task& definition) const;

  const LibrarySet& libraries_;
  const model::ComponentCatalog& catalog_;
  const LocalOptions options_;
  mutable Mutex mutex_;  ///< protects expected_
  std::map<model::TaskId, std::vector<ExpectedPort>> expected_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::task_host::detail
