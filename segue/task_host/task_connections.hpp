// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_host/commit_gates.hpp>
#include <segue/task_host/task_maker.hpp>
#include <segue/task_host/task_table.hpp>

#include <functional>
#include <span>

namespace segue::task_host::detail {

/// Connections between tasks of a table, and access to ports for connections to other processes. Thread safe.
/// All functions wait until `deadline` at most for hooks that create or remove ports (DeadlineExceeded).
class TaskConnections {
 public:
  TaskConnections(TaskTable& table, const TaskMaker& maker) : table_(table), maker_(maker) {}

  /// `at_commit`: the connection begins with the commit of the transition in progress, not at once.
  Result<void> connect(const model::Connection& connection, bool at_commit, TimePoint deadline);
  /// Lets the reader take what an ended connection owes it.
  Result<void> disconnect(const model::Connection& connection, TimePoint deadline);
  /// Waits until the reader has taken the samples that wait in a connection that has ended with a commit; for
  /// as long as the reader runs, and no longer than it needs for a full buffer.
  void let_reader_finish(const sample_link::PortConnection& connection, const model::TaskId& reader,
                         TimePoint deadline) const;

  /// The gate of the transition in progress; `ending` are the connections of this process that end with it.
  task::CommitGatePtr arm(std::shared_ptr<const task::CommitWord> word, std::uint64_t number,
                          std::span<const model::Connection> ending);
  /// For a connection to another process that begins with the commit.
  task::CommitGatePtr gate() { return gates_.for_connection(); }
  /// The transition has committed, or was given up: connections that would have begun with it are removed.
  void settle();

  /// Calls `use` with a port that is to be connected; it exists until `use` returns.
  Result<void> with_output(const model::PortRef& port, TimePoint deadline,
                           const std::function<Result<void>(task::OutputPortBase&)>& use);
  Result<void> with_input(const model::PortRef& port, TimePoint deadline,
                          const std::function<Result<void>(task::InputPortBase&)>& use);

 private:
  /// The common part of with_output() and with_input().
  template <class FindPort, class Use>
  Result<void> with_port(const model::PortRef& port, model::Direction direction, TimePoint deadline,
                         FindPort find_port, const Use& use);
  void drop_ended();
  /// The task at one end, unless it is specified to refuse connections.
  [[nodiscard]] Result<TaskEntry> find(const model::TaskId& id) const;

  TaskTable& table_;
  const TaskMaker& maker_;
  CommitGates gates_;
};

}  // namespace segue::task_host::detail
