// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/base/shared_mutex.hpp>
#include <segue/base/timed_mutex.hpp>
#include <segue/model/network.hpp>
#include <segue/task/executor_set.hpp>
#include <segue/task/task.hpp>
#include <segue/task_host/connection_handle.hpp>
#include <segue/task_host/stand_in.hpp>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <tuple>
#include <vector>

namespace segue::task_host::detail {

/// Protects the ports of a task, which configure and cleanup create and remove (and the properties of a
/// stand-in): readers hold it shared, those verbs exclusively. Locked with a deadline, since a hook may hang.
using PortsMutex = TimedMutex;

/// A task with its definition. A value: the table returns copies, so that nothing is locked while a hook
/// runs.
struct TaskEntry {
  std::shared_ptr<task::Task> task;
  std::shared_ptr<PortsMutex> ports;
  model::Task definition;  ///< as last applied, with properties that were changed from outside since
  model::DeploymentKey process;
  std::string name;  ///< inside the process
  bool stand_in = false;

  [[nodiscard]] TaskState state() const { return task->state(); }
  [[nodiscard]] bool configured() const { return is_configured(task->state()); }
};

/// A process of which only the name exists, and the threads that its tasks share.
struct ProcessEntry {
  model::Deployment deployment;
  std::shared_ptr<task::ExecutorSet> executors;
};

/// The error of other verbs while a hook holds the entry's ports.
Error busy(const TaskEntry& entry);
/// Locks the entry's ports for reading; DeadlineExceeded where a hook holds them too long.
Result<TimedReadLock> hold_ports(const TaskEntry& entry, TimePoint deadline);

/// Orders connections by their writers, so that those of one writer stand together.
struct ByWriter {
  using is_transparent = void;
  bool operator()(const model::Connection& a, const model::Connection& b) const {
    return std::tie(a.from, a.to, a.policy) < std::tie(b.from, b.to, b.policy);
  }
  bool operator()(const model::Connection& a, const model::TaskId& writer) const {
    return a.from.task < writer;
  }
  bool operator()(const model::TaskId& writer, const model::Connection& b) const {
    return writer < b.from.task;
  }
};

/// Orders connections by their readers, so that those of one reader stand together.
struct ByReader {
  using is_transparent = void;
  bool operator()(const model::Connection* a, const model::Connection* b) const {
    return std::tie(a->to, a->from, a->policy) < std::tie(b->to, b->from, b->policy);
  }
  bool operator()(const model::Connection* a, const model::TaskId& reader) const {
    return a->to.task < reader;
  }
  bool operator()(const model::TaskId& reader, const model::Connection* b) const {
    return reader < b->to.task;
  }
};

struct ConnectionEntry {
  model::Connection connection;
  ConnectionHandle handle;
};

/// The tasks, processes and connections of this process. Thread safe; every function is short and calls no
/// hook. A function that concerns one task takes a time that does not grow with the number of all others.
class TaskTable {
 public:
  /// NotFound, with the most similar name.
  [[nodiscard]] Result<TaskEntry> find(const model::TaskId& id) const;
  /// For whoever expects that it may be missing: find() composes its error from all names.
  [[nodiscard]] std::optional<TaskEntry> look_up(const model::TaskId& id) const;
  [[nodiscard]] std::vector<TaskEntry> all() const;
  [[nodiscard]] std::vector<TaskEntry> in_process(const model::DeploymentKey& process) const;
  /// Adds a task, or puts it in the place of another one, which is returned, so that it is destroyed without
  /// the lock. NotFound where its process has ended meanwhile.
  Result<std::shared_ptr<task::Task>> put(TaskEntry entry);
  /// Replaces the entry of `present`, which nobody destroys here. NotFound where that has been removed
  /// meanwhile.
  Result<void> update(const task::Task* present, TaskEntry entry);
  std::shared_ptr<task::Task> take(const model::TaskId& id);
  /// Changes the definition of a task that is still there.
  void redefine(const model::TaskId& id, const std::function<void(model::Task&)>& change);

  Result<void> add_process(const model::Deployment& deployment);
  [[nodiscard]] std::optional<ProcessEntry> find_process(const model::DeploymentKey& key) const;
  /// Removes the process with its tasks and their connections; returns the tasks.
  std::vector<std::shared_ptr<task::Task>> take_process(const model::DeploymentKey& key);
  [[nodiscard]] std::vector<model::Deployment> processes() const;

  /// NotFound where one of the two tasks has been removed meanwhile.
  Result<void> add_connection(ConnectionEntry entry, const task::Task* from, const task::Task* to);
  /// Removes the connection from the table.
  Result<ConnectionEntry> take_connection(const model::Connection& connection);
  /// Only connections that have not ended.
  [[nodiscard]] std::optional<ConnectionHandle> find_connection(const model::Connection& connection) const;
  [[nodiscard]] std::vector<ConnectionEntry> all_connections() const;
  /// Removes connections that have ended.
  void drop_ended_connections();
  /// Removes connections that have ended of a task of which ports were removed.
  void drop_ended_connections_of(const model::TaskId& id);
  /// Removes all connections of a task from the table.
  std::vector<ConnectionEntry> take_connections_of(const model::TaskId& id);

  void clear();

 private:
  [[nodiscard]] bool holds(const model::TaskId& id, const task::Task* task) const
      SEGUE_REQUIRES_SHARED(mutex_);
  using Connections = std::map<model::Connection, ConnectionEntry, ByWriter>;
  [[nodiscard]] std::vector<Connections::iterator> connections_of(const model::TaskId& id)
      SEGUE_REQUIRES(mutex_);
  ConnectionEntry take(Connections::iterator place) SEGUE_REQUIRES(mutex_);
  std::vector<ConnectionEntry> erase_connections_of(const model::TaskId& id) SEGUE_REQUIRES(mutex_);

  mutable SharedMutex mutex_;  ///< protects all below; no task is called while it is held
  std::map<model::TaskId, TaskEntry> tasks_ SEGUE_GUARDED_BY(mutex_);
  std::map<model::DeploymentKey, ProcessEntry> processes_ SEGUE_GUARDED_BY(mutex_);
  Connections connections_ SEGUE_GUARDED_BY(mutex_);
  /// The keys of connections_.
  std::set<const model::Connection*, ByReader> readers_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::task_host::detail
