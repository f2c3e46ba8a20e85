// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/host/wire_end.hpp>
#include <segue/link/port_connection.hpp>
#include <segue/model/network.hpp>

#include <memory>

namespace segue::host::detail {

/// A connection that stands, until it is taken off or one of its ports goes. Thread safe; destroying it
/// leaves the connection as it is.
class Wire {
 public:
  Wire() = default;
  explicit Wire(std::shared_ptr<link::PortConnection> connection) : connection_(std::move(connection)) {}

  [[nodiscard]] bool stands() const { return connection_ != nullptr && connection_->connected(); }
  void disconnect() { connection_->disconnect(); }
  [[nodiscard]] link::Counters counters() const { return connection_->counters(); }

 private:
  std::shared_ptr<link::PortConnection> connection_;
};

/// Connects two tasks' ports. Tasks may break meanwhile and unmake theirs.
Result<Wire> lay_wire(const WireEnd& from, const WireEnd& to, const model::Connection& connection);

}  // namespace segue::host::detail
