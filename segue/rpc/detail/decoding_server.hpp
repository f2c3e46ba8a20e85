// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rpc/detail/wire.hpp>

#include <capnp/capability.h>
#include <capnp/schema.h>

#include <cstdint>

namespace segue::control::detail {

/// Answers a call of any method of the protocol with an error: as its result `error`, or in its `answer`.
void answer_with_error(capnp::InterfaceSchema::Method method, const Error& error,
                       capnp::CallContext<capnp::AnyPointer, capnp::AnyPointer> context);

/// A base of servers: calls whose arguments cannot be decoded (WireError) are answered with the reason. A
/// method decodes all its arguments before it returns its promise; in a continuation it is too late.
template <class Interface>
class DecodingServer : public virtual Interface::Server {
 public:
  capnp::Capability::Server::DispatchCallResult dispatchCall(
      std::uint64_t interface_id, std::uint16_t method_id,
      capnp::CallContext<capnp::AnyPointer, capnp::AnyPointer> context) override {
    try {
      return Interface::Server::dispatchCall(interface_id, method_id, context);
    } catch (const WireError& malformed) {
      KJ_IF_MAYBE (called, capnp::Schema::from<Interface>().findSuperclass(interface_id)) {
        answer_with_error(called->getMethods()[method_id], malformed.error(), context);
        return {kj::READY_NOW, false};
      }
      throw;
    }
  }
};

}  // namespace segue::control::detail
