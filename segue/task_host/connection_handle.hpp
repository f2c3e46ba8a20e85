// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>
#include <segue/sample_link/port_connection.hpp>
#include <segue/task/component.hpp>
#include <segue/task/held_ports.hpp>

#include <memory>

namespace segue::task_host::detail {

/// A connection between two tasks of this process, which lasts until it is disconnected or one of its ports
/// is removed. Thread safe. Destroying the handle leaves the connection as it is.
class ConnectionHandle {
 public:
  ConnectionHandle() = default;
  explicit ConnectionHandle(std::shared_ptr<sample_link::PortConnection> connection)
      : connection_(std::move(connection)) {}

  [[nodiscard]] bool is_connected() const { return connection_ != nullptr && connection_->connected(); }
  void disconnect() { connection_->disconnect(); }
  [[nodiscard]] sample_link::Counters counters() const { return connection_->counters(); }
  /// See sample_link::PortConnection; is_connected() must have been true once.
  [[nodiscard]] sample_link::PortConnection& port_connection() const { return *connection_; }

 private:
  std::shared_ptr<sample_link::PortConnection> connection_;
};

/// One end of a connection: a task, whose component must outlive this.
struct ConnectionEnd {
  task::Component& component;
  bool stand_in = false;
  bool configured = false;
};

/// Adds the port to a stand-in that lacks it; does nothing for other components. Must not be called while
/// ports are held.
Result<void> add_missing_port(const ConnectionEnd& end, const model::PortRef& ref,
                              model::Direction direction);

/// The port, valid as long as `ports` holds it. NotFound names the ports that exist.
Result<task::OutputPortBase*> find_output(const task::HeldPorts& ports, const ConnectionEnd& end,
                                          const model::PortRef& ref);
Result<task::InputPortBase*> find_input(const task::HeldPorts& ports, const ConnectionEnd& end,
                                        const model::PortRef& ref);

/// Connects two tasks' ports, which the tasks may remove at the same time. With a gate, the connection is
/// dormant until that opens.
Result<ConnectionHandle> connect_ports(const ConnectionEnd& from, const ConnectionEnd& to,
                                       const model::Connection& connection, task::CommitGatePtr gate);

}  // namespace segue::task_host::detail
