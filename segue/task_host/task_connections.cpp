// SPDX-License-Identifier: Apache-2.0
#include <segue/task_host/task_connections.hpp>

#include <segue/base/text.hpp>

#include <algorithm>
#include <thread>

namespace segue::task_host::detail {

namespace {

/// The time that a reader has beyond one cycle for each sample: until its thread runs.
constexpr Duration kReadingPatience = std::chrono::milliseconds(100);
constexpr Duration kReadingPoll = std::chrono::microseconds(500);

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

Result<void> TaskConnections::connect(const model::Connection& connection, bool at_commit,
                                      TimePoint deadline) {
  if (const auto present = table_.find_connection(connection)) {
    if (present->port_connection().carries() || present->port_connection().dormant()) {
      return fail(ErrorCode::AlreadyExists, "is already connected");
    }
    present->port_connection().disconnect();  // it has ended with an earlier transition
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
  Result<TimedReadLock> to_ports;  // a task may be connected with itself
  if (to->ports != from->ports) {
    to_ports = hold_ports(*to, deadline);
    if (!to_ports) {
      return to_ports.error();
    }
  }
  auto handle =
      connect_ports(end_of(*from), end_of(*to), connection, at_commit ? gates_.for_connection() : nullptr);
  if (!handle) {
    return std::move(handle.error());
  }
  auto added = table_.add_connection({connection, *handle}, from->task.get(), to->task.get());
  if (!added) {
    handle->disconnect();
  }
  return added;
}

Result<void> TaskConnections::disconnect(const model::Connection& connection, TimePoint deadline) {
  auto entry = table_.take_connection(connection);
  if (!entry) {
    return std::move(entry.error());
  }
  entry->handle.port_connection().settle();
  let_reader_finish(entry->handle.port_connection(), connection.to.task, deadline);
  entry->handle.disconnect();
  return {};
}

void TaskConnections::let_reader_finish(const sample_link::PortConnection& connection,
                                        const model::TaskId& reader, TimePoint deadline) const {
  const auto entry = table_.look_up(reader);
  if (!entry) {
    return;
  }
  const auto cycles = static_cast<Duration::rep>(connection.policy().size) + 1;
  const TimePoint now = RealClock::instance().now();
  const TimePoint end = std::min(deadline, now + kReadingPatience + cycles * entry->task->activity().period);
  while (connection.owes_samples() && entry->state() == TaskState::Running &&
         RealClock::instance().now() < end) {
    std::this_thread::sleep_for(kReadingPoll);
  }
}

task::CommitGatePtr TaskConnections::arm(std::shared_ptr<const task::CommitWord> word, std::uint64_t number,
                                         std::span<const model::Connection> ending) {
  drop_ended();
  auto gate = gates_.arm(std::move(word), number);
  for (const auto& connection : ending) {
    if (const auto handle = table_.find_connection(connection)) {
      handle->port_connection().end_at(gate);
    }
  }
  return gate;
}

/// Disconnects the connections that ended with an earlier transition which did not get that far.
void TaskConnections::drop_ended() {
  for (const ConnectionEntry& entry : table_.all_connections()) {
    const sample_link::PortConnection& connection = entry.handle.port_connection();
    if (!connection.carries() && !connection.dormant()) {
      entry.handle.port_connection().disconnect();
    }
  }
  table_.drop_ended_connections();
}

void TaskConnections::settle() {
  gates_.drop();
  for (const ConnectionEntry& entry : table_.all_connections()) {
    sample_link::PortConnection& connection = entry.handle.port_connection();
    connection.settle();
    if (connection.dormant()) {
      connection.disconnect();
    }
  }
  table_.drop_ended_connections();
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

}  // namespace segue::task_host::detail
