// SPDX-License-Identifier: Apache-2.0
#include <segue/base/log.hpp>
#include <segue/control/detail/session.hpp>
#include <segue/control/detail/wire.hpp>

#include <kj/debug.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

namespace segue::control::detail {

namespace {

/// A client that leaves more than this unread is not heard until it has read some. Messages count too, since
/// each that waits is a link in a chain that is taken down recursively.
constexpr std::size_t kMaxUnreadBytes = std::size_t{16} << 20;
constexpr std::size_t kMaxUnreadMessages = 256;
constexpr auto kUnreadPause = 10 * kj::MILLISECONDS;
constexpr auto kHelloTimeout = 5 * kj::SECONDS;
constexpr auto kAcceptPause = 100 * kj::MILLISECONDS;

capnp::ReaderOptions reader_options() {
  capnp::ReaderOptions options;
  options.traversalLimitInWords = kServerMessageWords;
  options.nestingLimit = kMessageNesting;
  return options;
}

/// Passes everything on, but does not read from a client that does not read.
class GuardedStream final : public kj::AsyncIoStream {
 public:
  GuardedStream(kj::Own<kj::AsyncIoStream> inner, kj::Timer& timer) : inner_(kj::mv(inner)), timer_(timer) {}

  void watch(capnp::TwoPartyVatNetwork& network) { network_ = &network; }

  kj::Promise<size_t> tryRead(void* buffer, size_t minimum, size_t maximum) override {
    if (!is_backed_up()) return inner_->tryRead(buffer, minimum, maximum);
    return timer_.afterDelay(kUnreadPause).then([this, buffer, minimum, maximum] {
      return tryRead(buffer, minimum, maximum);
    });
  }
  kj::Promise<void> write(const void* buffer, size_t size) override { return inner_->write(buffer, size); }
  kj::Promise<void> write(kj::ArrayPtr<const kj::ArrayPtr<const kj::byte>> pieces) override {
    return inner_->write(pieces);
  }
  kj::Promise<void> whenWriteDisconnected() override { return inner_->whenWriteDisconnected(); }
  void shutdownWrite() override { inner_->shutdownWrite(); }

 private:
  [[nodiscard]] bool is_backed_up() const {
    return network_ != nullptr && (network_->getCurrentQueueSize() > kMaxUnreadBytes ||
                                   network_->getCurrentQueueCount() > kMaxUnreadMessages);
  }

  kj::Own<kj::AsyncIoStream> inner_;
  kj::Timer& timer_;
  capnp::TwoPartyVatNetwork* network_ = nullptr;
};

/// Lets in whoever speaks our version.
class GateServer final : public wire::Gate::Server {
 public:
  GateServer(ServerCore& core, std::shared_ptr<ClientState> client, bool full)
      : core_(core), client_(std::move(client)), full_(full) {}

  kj::Promise<void> hello(HelloContext context) override {
    const auto params = context.getParams();
    const auto refused = refusal(params.getVersion(), as_string(params.getSoftware()));
    auto results = context.getResults();
    results.setVersion(kProtocolVersion);
    results.setSoftware(SEGUE_VERSION);
    if (refused) {
      encode(*refused, results.initError());
    } else {
      client_->greeted = true;
      results.setRobot(make_robot_server(core_, client_));
    }
    return kj::READY_NOW;
  }

 private:
  [[nodiscard]] std::optional<Error> refusal(std::uint32_t version, const std::string& software) const {
    if (version != kProtocolVersion) {
      return fail(ErrorCode::Unsupported, "the robot runs segue " SEGUE_VERSION " and speaks version " +
                                              std::to_string(kProtocolVersion) +
                                              " of the control protocol, segue " + software.substr(0, 32) +
                                              " speaks version " + std::to_string(version) +
                                              "; use the segue command that the robot was started with");
    }
    if (full_) {
      return fail(ErrorCode::ResourceExhausted, "the robot already has " +
                                                    std::to_string(Sessions::kMaxClients) +
                                                    " clients; close one and try again");
    }
    return std::nullopt;
  }

  ServerCore& core_;
  std::shared_ptr<ClientState> client_;
  bool full_;
};

}  // namespace

/// One connection, from accept to its end.
class Session {
 public:
  Session(Sessions& owner, kj::Own<kj::AsyncIoStream> stream, bool full)
      : owner_(owner),
        client_(std::make_shared<ClientState>()),
        stream_(kj::mv(stream), owner.timer_),
        network_(stream_, capnp::rpc::twoparty::Side::SERVER, reader_options()),
        rpc_(capnp::makeRpcServer(network_, kj::heap<GateServer>(owner.core_, client_, full))) {
    stream_.watch(network_);
    rpc_.setFlowLimit(kServerMessageWords);
    owner_.sessions_.insert(this);
  }
  ~Session() noexcept { owner_.sessions_.erase(this); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Resolves when the client is gone, or late with its hello.
  kj::Promise<void> end() {
    auto late = owner_.timer_.afterDelay(kHelloTimeout).then([this]() -> kj::Promise<void> {
      if (client_->greeted) return kj::NEVER_DONE;
      return kj::READY_NOW;
    });
    return network_.onDisconnect().exclusiveJoin(kj::mv(late));
  }

  [[nodiscard]] bool idle() const { return client_->calls == 0 && network_.getCurrentQueueCount() == 0; }

 private:
  Sessions& owner_;
  std::shared_ptr<ClientState> client_;
  GuardedStream stream_;
  mutable capnp::TwoPartyVatNetwork network_;
  capnp::RpcSystem<capnp::rpc::twoparty::VatId> rpc_;
};

Sessions::Sessions(ServerCore& core, kj::AsyncIoContext& io, const ListeningSocket& socket)
    : core_(core),
      timer_(io.provider->getTimer()),
      receiver_(io.lowLevelProvider->wrapListenSocketFd(socket.descriptor(),
                                                        kj::LowLevelAsyncIoProvider::ALREADY_NONBLOCK)),
      tasks_(*this),
      accepting_(
          accept().eagerlyEvaluate([this](kj::Exception&& exception) { taskFailed(kj::mv(exception)); })) {}

Sessions::~Sessions() noexcept = default;

void Sessions::stop_accepting() {
  accepting_ = nullptr;
  receiver_ = nullptr;
}

bool Sessions::idle() const {
  return std::all_of(sessions_.begin(), sessions_.end(),
                     [](const Session* session) { return session->idle(); });
}

/// What ends a session with an error is the client's fault and no news: garbage, half a message, a reset.
void Sessions::taskFailed(kj::Exception&& exception) {
  log(LogLevel::Debug, "control", exception.getDescription().cStr());
}

kj::Promise<void> Sessions::accept() {
  return receiver_->accept().then(
      [this](kj::Own<kj::AsyncIoStream>&& stream) {
        admit(kj::mv(stream));
        return accept();
      },
      [this](kj::Exception&& exception) {  // out of descriptors: the next may be more lucky
        log(LogLevel::Warning, "control",
            std::string("cannot accept a client: ") + exception.getDescription().cStr());
        return timer_.afterDelay(kAcceptPause).then([this] { return accept(); });
      });
}

void Sessions::admit(kj::Own<kj::AsyncIoStream> stream) {
  int descriptor = -1;
  KJ_IF_MAYBE (fd, stream->getFd()) {
    descriptor = *fd;
  }
  if (const auto trusted = check_peer(descriptor); !trusted) {
    log(LogLevel::Warning, "control", "refused a client: " + trusted.error().message);
    return;
  }
  if (sessions_.size() >= kMaxClients + kMaxRefused) return;
  const bool full = sessions_.size() >= kMaxClients;
  auto session = kj::heap<Session>(*this, kj::mv(stream), full);
  auto end = session->end();
  tasks_.add(end.attach(kj::mv(session)));
}

}  // namespace segue::control::detail
