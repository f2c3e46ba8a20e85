// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/host/task_maker.hpp>
#include <segue/host/task_table.hpp>

#include <functional>

namespace segue::host::detail {

/// Connections between tasks of a table, and access to ports for connections to other processes. Thread safe.
/// All functions wait until `deadline` at most for hooks that create or remove ports (DeadlineExceeded).
class TaskConnections {
 public:
  TaskConnections(TaskTable& table, const TaskMaker& maker) : table_(table), maker_(maker) {}

  Result<void> connect(const model::Connection& connection, TimePoint deadline);
  Result<void> disconnect(const model::Connection& connection);

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
  /// The task at one end, unless it is specified to refuse connections.
  [[nodiscard]] Result<TaskEntry> find(const model::TaskId& id) const;

  TaskTable& table_;
  const TaskMaker& maker_;
};

}  // namespace segue::host::detail
