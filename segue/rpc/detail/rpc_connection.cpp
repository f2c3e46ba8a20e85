// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/rpc/connection_table.hpp>
#include <segue/rpc/detail/event_loop.hpp>
#include <segue/rpc/detail/rpc_connection.hpp>

#include <kj/debug.h>

#include <string>
#include <utility>

namespace segue::control::detail {

namespace {

using type::Value;

capnp::ReaderOptions reader_options() {
  capnp::ReaderOptions options;
  options.traversalLimitInWords = kClientMessageWords;
  options.nestingLimit = kMessageNesting;
  return options;
}

kj::Exception not_connected() {
  return KJ_EXCEPTION(DISCONNECTED, "not connected");
}

wire::Bootstrap::Client bootstrap_of(capnp::RpcSystem<capnp::rpc::twoparty::VatId>& rpc) {
  capnp::MallocMessageBuilder message(8);
  auto id = message.initRoot<capnp::rpc::twoparty::VatId>();
  id.setSide(capnp::rpc::twoparty::Side::SERVER);
  return rpc.bootstrap(id).castAs<wire::Bootstrap>();
}

}  // namespace

RpcConnection::RpcConnection(kj::Own<kj::AsyncCapabilityStream> stream, SecureStream* secure,
                             unsigned descriptors)
    : stream_(kj::mv(stream)),
      secure_(secure),
      network_(*stream_, descriptors, capnp::rpc::twoparty::Side::CLIENT, reader_options()),
      rpc_(capnp::makeRpcClient(network_)),
      service_(kj::Exception(not_connected())) {}

capnp::Capability::Client RpcConnection::held_capability(StreamId id) {
  const auto found = held_.find(id);
  if (found == held_.end()) return not_connected();
  return found->second;
}

RpcConnection::Answer RpcConnection::hello(std::string_view kind) {
  auto request = bootstrap_of(rpc_).helloRequest();
  request.setVersion(kProtocolVersion);
  request.setSoftware(SEGUE_VERSION);
  request.setWants(as_text(std::string(kind)));
  auto sent = request.send();
  service_ = sent.getService();
  return sent.then([this](auto&& response) -> Result<Value> {
    if (const auto version = response.getVersion(); version != kProtocolVersion) {
      return fail(ErrorCode::InvalidState, "segue " + as_string(response.getSoftware()) +
                                               " answers, which speaks version " + std::to_string(version) +
                                               " of the control protocol; this is segue " SEGUE_VERSION
                                               ", which speaks version " +
                                               std::to_string(kProtocolVersion) +
                                               "; use programs of one version, or start that one anew");
    }
    if (response.hasError()) return decode(response.getError());
    service_ = response.getService();
    return Value(as_string(response.getSoftware()));
  });
}

void RpcConnection::watch(std::function<void()> gone) {
  watch_ = nullptr;
  if (gone) watch_ = network_.onDisconnect().then(std::move(gone)).eagerlyEvaluate(nullptr);
}

kj::Promise<void> RpcConnection::guard(kj::Timer& timer, Credentials credentials, Identity other) {
  auto period = timer.afterDelay(to_kj(ConnectionTable::kWatchPeriod));
  return period.then([this, &timer, credentials = std::move(credentials),
                      other = std::move(other)]() mutable -> kj::Promise<void> {
    credentials.encryption().refresh();
    const auto refused = credentials.encryption().refusal(other);
    if (!refused) return guard(timer, std::move(credentials), std::move(other));
    secure_->break_off(*refused);
    return kj::READY_NOW;
  });
}

std::optional<Error> RpcConnection::problem() const {
  return secure_ == nullptr ? std::nullopt : secure_->problem();
}

}  // namespace segue::control::detail
