// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/rpc/connection_table.hpp>
#include <segue/rpc/detail/bootstrap_server.hpp>

#include <optional>
#include <string>
#include <utility>

namespace segue::control::detail {

namespace {

/// Accepts clients of the same protocol version that request the service which is offered.
class BootstrapServer final : public wire::Bootstrap::Server {
 public:
  BootstrapServer(ServerCore& core, std::shared_ptr<ClientState> client, std::function<bool()> enter)
      : core_(core), client_(std::move(client)), enter_(std::move(enter)) {}

  kj::Promise<void> hello(HelloContext context) override {
    const auto params = context.getParams();
    const auto refused =
        refusal(params.getVersion(), as_string(params.getSoftware()), as_string(params.getWants()));
    auto results = context.getResults();
    results.setVersion(kProtocolVersion);
    results.setSoftware(SEGUE_VERSION);
    results.setServes(as_text(std::string(core_.offered.kind().name)));
    if (refused) {
      if (!client_->peer.local) core_.refusals.tell(to_string(client_->peer), refused->message);
      encode(*refused, results.initError());
    } else {
      results.setService(core_.offered.make_server(Caller(core_, client_)));
    }
    return kj::READY_NOW;
  }

 private:
  [[nodiscard]] std::optional<Error> refusal(std::uint32_t version, const std::string& software,
                                             const std::string& wants) const {
    const std::string us(core_.noun());
    if (version != kProtocolVersion) {
      return fail(ErrorCode::Unsupported,
                  us + " runs segue " SEGUE_VERSION " and speaks version " +
                      std::to_string(kProtocolVersion) + " of the control protocol, segue " +
                      software.substr(0, 32) + " speaks version " + std::to_string(version) +
                      "; use programs of one version, that which the robot was started with");
    }
    if (wants != core_.offered.kind().name) {
      return fail(ErrorCode::Unsupported,
                  "the service " + quote(wants.substr(0, 32)) + " was asked for where " + us + " (" +
                      quote(core_.offered.kind().name) + ") answers; give another socket");
    }
    if (!enter_()) {
      return fail(ErrorCode::ResourceExhausted, us + " refuses further connections (" +
                                                    std::to_string(ConnectionTable::kMostClients) +
                                                    " are open); close one and try again");
    }
    return std::nullopt;
  }

  ServerCore& core_;
  std::shared_ptr<ClientState> client_;
  const std::function<bool()> enter_;
};

}  // namespace

wire::Bootstrap::Client make_bootstrap(ServerCore& core, std::shared_ptr<ClientState> client,
                                       std::function<bool()> enter) {
  return kj::heap<BootstrapServer>(core, std::move(client), std::move(enter));
}

}  // namespace segue::control::detail
