// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/rpc/detail/encryption.hpp>
#include <segue/rpc/detail/wire.hpp>
#include <segue/rpc/endpoint.hpp>

#include <capnp/rpc-twoparty.h>

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string_view>

namespace segue::control::detail {

/// A client's connection; used in the thread of its event loop only.
class RpcConnection {
 public:
  /// Identifies a stream that was opened on the other side and is kept here.
  using StreamId = std::uint64_t;
  using Answer = kj::Promise<Result<type::Value>>;
  /// The largest answer, in nodes, that a client accepts.
  static constexpr std::uint64_t kMaxNodes = kClientMessageWords;

  /// `descriptors` is how many a message may carry. `secure` is the stream where that uses TLS, else null.
  RpcConnection(kj::Own<kj::AsyncCapabilityStream> stream, SecureStream* secure, unsigned descriptors);

  /// The service that hello() requests. Calls of it before the answer are sent together with hello(), and
  /// fail where that is refused; without hello() every call answers with an exception.
  template <class Interface>
  typename Interface::Client as() {
    return service_.castAs<Interface>();
  }
  /// A capability that hold() has kept; an unknown one answers every call with an exception.
  template <class Interface>
  typename Interface::Client held(StreamId id) {
    return held_capability(id).castAs<Interface>();
  }
  void hold(StreamId id, capnp::Capability::Client capability) {
    held_.insert_or_assign(id, kj::mv(capability));
  }
  template <class Request>
  Answer open(StreamId id, Request& request);
  void close(StreamId id) { held_.erase(id); }
  /// Exchanges versions and requests the service of that kind; the answer is the version of the other side.
  Answer hello(std::string_view kind);
  /// Calls `gone`, in the loop's thread, when the connection breaks.
  void watch(std::function<void()> gone);
  /// Breaks the connection within a second once the certificate of the other side is revoked or expires.
  kj::Promise<void> guard(kj::Timer& timer, Credentials credentials, Identity other);
  /// Why the connection broke, where TLS says so.
  [[nodiscard]] std::optional<Error> problem() const;

 private:
  capnp::Capability::Client held_capability(StreamId id);

  kj::Own<kj::AsyncCapabilityStream> stream_;
  SecureStream* secure_;
  capnp::TwoPartyVatNetwork network_;
  capnp::RpcSystem<capnp::rpc::twoparty::VatId> rpc_;
  capnp::Capability::Client service_;
  std::map<StreamId, capnp::Capability::Client> held_;
  kj::Promise<void> watch_ = nullptr;
};

template <class Request>
RpcConnection::Answer RpcConnection::open(StreamId id, Request& request) {
  return request.send().then([this, id](auto&& response) -> Result<type::Value> {
    auto type = decode(response.getAnswer(), kMaxNodes);
    if (type) hold(id, response.getStream());
    return type;
  });
}

}  // namespace segue::control::detail
