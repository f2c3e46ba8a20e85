// SPDX-License-Identifier: Apache-2.0
#include <segue/host/task_connections.hpp>

#include <segue/base/text.hpp>

namespace segue::host::detail {

namespace {

using PortsLock = std::shared_lock<PortsMutex>;

ConnectionEnd end_of(const TaskEntry& entry) {
  return {entry.task->component(), entry.stand_in, entry.configured()};
}

}  // namespace

Result<TaskEntry> TaskConnections::find(const model::TaskId& id) const {
  auto entry = table_.find(id);
  if (entry && entry->stand_in && maker_.behaviour_of(entry->definition).fails("connect")) {
    return fail(ErrorCode::HookFailed, "stand_in.fail of task " + quote(id.str()) + " names 'connect'");
  }
  return entry;
}

Result<void> TaskConnections::connect(const model::Connection& connection, TimePoint deadline) {
  if (table_.has_connection(connection)) {
    return fail(ErrorCode::AlreadyExists, "is already connected");
  }
  auto from = find(connection.from.task);
  if (!from) {
    return std::move(from.error());
  }
  auto to = find(connection.to.task);
  if (!to) {
    return std::move(to.error());
  }
  const auto from_ports = hold_ports(*from, deadline);
  if (!from_ports) {
    return from_ports.error();
  }
  Result<PortsLock> to_ports;  // a task may be connected with itself
  if (to->ports != from->ports) {
    to_ports = hold_ports(*to, deadline);
    if (!to_ports) {
      return to_ports.error();
    }
  }
  auto handle = connect_ports(end_of(*from), end_of(*to), connection);
  if (!handle) {
    return std::move(handle.error());
  }
  return table_.add_connection({connection, std::move(*handle)});
}

Result<void> TaskConnections::disconnect(const model::Connection& connection) {
  auto entry = table_.take_connection(connection);
  if (!entry) {
    return std::move(entry.error());
  }
  entry->handle.disconnect();
  return {};
}

template <class FindPort, class Use>
Result<void> TaskConnections::with_port(const model::PortRef& port, model::Direction direction,
                                        TimePoint deadline, FindPort find_port, const Use& use) {
  const auto entry = find(port.task);
  if (!entry) {
    return entry.error();
  }
  const auto lock = hold_ports(*entry, deadline);
  if (!lock) {
    return lock.error();
  }
  const ConnectionEnd end = end_of(*entry);
  if (auto grown = add_missing_port(end, port, direction); !grown) {
    return grown;
  }
  const task::HeldPorts ports(end.component);
  const auto found = find_port(ports, end, port);
  return found ? use(**found) : found.error();
}

Result<void> TaskConnections::with_output(const model::PortRef& port, TimePoint deadline,
                                          const std::function<Result<void>(task::OutputPortBase&)>& use) {
  return with_port(port, model::Direction::Output, deadline, find_output, use);
}

Result<void> TaskConnections::with_input(const model::PortRef& port, TimePoint deadline,
                                         const std::function<Result<void>(task::InputPortBase&)>& use) {
  return with_port(port, model::Direction::Input, deadline, find_input, use);
}

}  // namespace segue::host::detail
