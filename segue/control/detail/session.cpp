// SPDX-License-Identifier: Apache-2.0
#include <segue/base/log.hpp>
#include <segue/base/text.hpp>
#include <segue/control/detail/services.hpp>
#include <segue/control/detail/session.hpp>
#include <segue/control/detail/wire.hpp>

#include <kj/debug.h>
#include <kj/io.h>

#include <fcntl.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

namespace segue::control::detail {

namespace {

/// A client that leaves more than this unread is not read from until it has read some. The number of messages
/// counts too, since those that wait form a chain of promises, which is destroyed recursively.
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

/// An offer of memory has two descriptors; no other message has any.
constexpr unsigned kMaxDescriptors = 2;

/// Passes all calls on, but does not read from a client that does not read its answers.
class GuardedStream final : public kj::AsyncCapabilityStream {
 public:
  GuardedStream(kj::Own<kj::AsyncCapabilityStream> inner, kj::Timer& timer)
      : inner_(kj::mv(inner)), timer_(timer) {}

  void watch(capnp::TwoPartyVatNetwork& network) { network_ = &network; }

  kj::Promise<size_t> tryRead(void* buffer, size_t minimum, size_t maximum) override {
    if (!is_backed_up()) return inner_->tryRead(buffer, minimum, maximum);
    return pause().then([this, buffer, minimum, maximum] { return tryRead(buffer, minimum, maximum); });
  }
  kj::Promise<ReadResult> tryReadWithFds(void* buffer, size_t minimum, size_t maximum, kj::AutoCloseFd* fds,
                                         size_t max_fds) override {
    if (!is_backed_up()) return inner_->tryReadWithFds(buffer, minimum, maximum, fds, max_fds);
    return pause().then([this, buffer, minimum, maximum, fds, max_fds] {
      return tryReadWithFds(buffer, minimum, maximum, fds, max_fds);
    });
  }
  kj::Promise<ReadResult> tryReadWithStreams(void* buffer, size_t minimum, size_t maximum,
                                             kj::Own<kj::AsyncCapabilityStream>* streams,
                                             size_t max_streams) override {
    return inner_->tryReadWithStreams(buffer, minimum, maximum, streams, max_streams);
  }
  kj::Promise<void> write(const void* buffer, size_t size) override { return inner_->write(buffer, size); }
  kj::Promise<void> write(kj::ArrayPtr<const kj::ArrayPtr<const kj::byte>> pieces) override {
    return inner_->write(pieces);
  }
  kj::Promise<void> writeWithFds(kj::ArrayPtr<const kj::byte> data,
                                 kj::ArrayPtr<const kj::ArrayPtr<const kj::byte>> more,
                                 kj::ArrayPtr<const int> fds) override {
    return inner_->writeWithFds(data, more, fds);
  }
  kj::Promise<void> writeWithStreams(kj::ArrayPtr<const kj::byte> data,
                                     kj::ArrayPtr<const kj::ArrayPtr<const kj::byte>> more,
                                     kj::Array<kj::Own<kj::AsyncCapabilityStream>> streams) override {
    return inner_->writeWithStreams(data, more, kj::mv(streams));
  }
  kj::Promise<void> whenWriteDisconnected() override { return inner_->whenWriteDisconnected(); }
  void shutdownWrite() override { inner_->shutdownWrite(); }

 private:
  kj::Promise<void> pause() { return timer_.afterDelay(kUnreadPause); }

  [[nodiscard]] bool is_backed_up() const {
    return network_ != nullptr && (network_->getCurrentQueueSize() > kMaxUnreadBytes ||
                                   network_->getCurrentQueueCount() > kMaxUnreadMessages);
  }

  kj::Own<kj::AsyncCapabilityStream> inner_;
  kj::Timer& timer_;
  capnp::TwoPartyVatNetwork* network_ = nullptr;
};

bool takes_descriptors(const ServerCore& core) {
  return core.kind() == kDeploymentKind;
}

capnp::Capability::Client make_service(const Caller& caller) {
  const std::string_view kind = caller.core().kind();
  if (kind == kDeploymentKind) return make_deployment_server(caller);
  if (kind == kProcessesKind) return make_processes_server(caller);
  if (kind == kHostKind) return make_host_server(caller);
  return make_robot_server(caller);
}

/// Accepts clients of the same protocol version that request the service which is offered.
class GateServer final : public wire::Gate::Server {
 public:
  GateServer(ServerCore& core, std::shared_ptr<ClientState> client, const Sessions& others)
      : core_(core), client_(std::move(client)), others_(others) {}

  kj::Promise<void> hello(HelloContext context) override {
    const auto params = context.getParams();
    const auto refused =
        refusal(params.getVersion(), as_string(params.getSoftware()), as_string(params.getWants()));
    auto results = context.getResults();
    results.setVersion(kProtocolVersion);
    results.setSoftware(SEGUE_VERSION);
    results.setServes(as_text(std::string(core_.kind())));
    if (refused) {
      encode(*refused, results.initError());
    } else {
      client_->greeted = true;
      results.setService(make_service(Caller(core_, client_)));
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
    if (wants != core_.kind()) {
      return fail(ErrorCode::Unsupported, "the service " + quote(wants.substr(0, 32)) +
                                              " was asked for where " + us + " (" + quote(core_.kind()) +
                                              ") answers; give another socket");
    }
    if (const std::size_t open = others_.clients(); !client_->greeted && open >= Sessions::kMaxClients) {
      return fail(ErrorCode::ResourceExhausted, us + " refuses further connections (" + std::to_string(open) +
                                                    " are open); close one and try again");
    }
    return std::nullopt;
  }

  ServerCore& core_;
  std::shared_ptr<ClientState> client_;
  const Sessions& others_;
};

}  // namespace

/// One connection, from accept to its end.
class Session {
 public:
  Session(Sessions& owner, kj::Own<kj::AsyncCapabilityStream> stream)
      : owner_(owner),
        client_(std::make_shared<ClientState>()),
        stream_(kj::mv(stream), owner.timer_),
        network_(stream_, takes_descriptors(owner.core_) ? kMaxDescriptors : 0,
                 capnp::rpc::twoparty::Side::SERVER, reader_options()),
        cut_off_(kj::newPromiseAndFulfiller<void>()),
        rpc_(capnp::makeRpcServer(network_, kj::heap<GateServer>(owner.core_, client_, owner))) {
    stream_.watch(network_);
    rpc_.setFlowLimit(kServerMessageWords);
    owner_.sessions_.push_back(this);
  }
  ~Session() noexcept { std::erase(owner_.sessions_, this); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Resolves when the client is gone or cut off, or has not said hello in time.
  kj::Promise<void> end() {
    auto late = owner_.timer_.afterDelay(kHelloTimeout).then([this]() -> kj::Promise<void> {
      if (client_->greeted) return kj::NEVER_DONE;
      return kj::READY_NOW;
    });
    return network_.onDisconnect().exclusiveJoin(kj::mv(late)).exclusiveJoin(kj::mv(cut_off_.promise));
  }
  /// Lets end() resolve; only once.
  void cut_off() {
    is_cut_off_ = true;
    cut_off_.fulfiller->fulfill();
  }
  [[nodiscard]] bool is_cut_off() const { return is_cut_off_; }
  [[nodiscard]] bool greeted() const { return client_->greeted; }

  [[nodiscard]] bool idle() const { return client_->calls == 0 && network_.getCurrentQueueCount() == 0; }

 private:
  Sessions& owner_;
  std::shared_ptr<ClientState> client_;
  GuardedStream stream_;
  mutable capnp::TwoPartyVatNetwork network_;
  kj::PromiseFulfillerPair<void> cut_off_;
  bool is_cut_off_ = false;
  capnp::RpcSystem<capnp::rpc::twoparty::VatId> rpc_;
};

Sessions::Sessions(ServerCore& core, kj::AsyncIoContext& io, const ListeningSocket& socket)
    : core_(core),
      io_(*io.lowLevelProvider),
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

std::size_t Sessions::clients() const {
  return static_cast<std::size_t>(std::ranges::count_if(sessions_, &Session::greeted));
}

/// Cuts off the oldest connection whose client was not accepted, if there are too many of them.
void Sessions::make_room() {
  const auto other = [](const Session* session) { return !session->greeted() && !session->is_cut_off(); };
  const auto count = static_cast<std::size_t>(std::ranges::count_if(sessions_, other));
  if (count >= kMaxOthers) (*std::ranges::find_if(sessions_, other))->cut_off();
}

/// A session ends with an error through a fault of its client, such as garbage, half a message or a reset, so
/// this is only logged for debugging.
void Sessions::taskFailed(kj::Exception&& exception) {
  log(LogLevel::Debug, "control", exception.getDescription().cStr());
}

kj::Promise<void> Sessions::accept() {
  return receiver_->accept().then(
      [this](kj::Own<kj::AsyncIoStream>&& stream) {
        admit(*stream);
        return accept();
      },
      [this](kj::Exception&& exception) {  // there are no descriptors left: try again later
        log(LogLevel::Warning, "control",
            std::string("cannot accept a client: ") + exception.getDescription().cStr());
        return timer_.afterDelay(kAcceptPause).then([this] { return accept(); });
      });
}

void Sessions::admit(const kj::AsyncIoStream& accepted) {
  Descriptor socket;
  KJ_IF_MAYBE (fd, accepted.getFd()) {
    socket = Descriptor(::fcntl(*fd, F_DUPFD_CLOEXEC, 0));
  }
  if (const auto trusted = check_peer(socket.get()); !trusted) {
    log(LogLevel::Warning, "control", "refused a client: " + trusted.error().message);
    return;
  }
  make_room();
  auto stream = io_.wrapUnixSocketFd(
      kj::AutoCloseFd(socket.release()),
      kj::LowLevelAsyncIoProvider::ALREADY_CLOEXEC | kj::LowLevelAsyncIoProvider::ALREADY_NONBLOCK);
  auto session = kj::heap<Session>(*this, kj::mv(stream));
  auto end = session->end();
  tasks_.add(end.attach(kj::mv(session)));
}

}  // namespace segue::control::detail
