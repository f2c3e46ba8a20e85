// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <capnp/capability.h>

#include <string_view>

namespace segue::control::detail {

class Caller;
class EventLoop;

/// A kind of service, which a client asks for and a server offers.
struct ServiceKind {
  std::string_view name;     ///< in the protocol
  std::string_view noun;     ///< in messages: "the robot"
  unsigned descriptors = 0;  ///< the most that a message carries. Such a service is for Unix sockets only
};

/// The service that a server offers to all its clients. Used in its event loop only.
class OfferedService {
 public:
  explicit OfferedService(const ServiceKind& kind) : kind_(kind) {}
  virtual ~OfferedService() = default;
  OfferedService(const OfferedService&) = delete;
  OfferedService& operator=(const OfferedService&) = delete;

  [[nodiscard]] const ServiceKind& kind() const { return kind_; }
  /// For a client that has come in.
  virtual capnp::Capability::Client make_server(const Caller& caller) = 0;
  /// The service's events go to those who listen from now on, through `loop`; null: they go nowhere. May be
  /// called from any thread.
  virtual void report_events(EventLoop* /*loop*/) {}

 private:
  const ServiceKind kind_;
};

}  // namespace segue::control::detail
