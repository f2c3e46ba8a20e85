// SPDX-License-Identifier: Apache-2.0
#include <segue/base/log.hpp>
#include <segue/base/text.hpp>
#include <segue/rpc/detail/bounded_reads.hpp>
#include <segue/rpc/detail/guarded_stream.hpp>
#include <segue/rpc/detail/server_sessions.hpp>
#include <segue/rpc/detail/socket.hpp>
#include <segue/rpc/detail/tcp_socket.hpp>
#include <segue/rpc/detail/wire.hpp>

#include <kj/debug.h>
#include <kj/io.h>

#include <fcntl.h>

#include <algorithm>
#include <string>
#include <utility>

namespace segue::control::detail {

namespace {

constexpr auto kAcceptPause = 100 * kj::MILLISECONDS;

capnp::ReaderOptions limits_of(std::uint64_t words) {
  capnp::ReaderOptions options;
  options.traversalLimitInWords = words;
  options.nestingLimit = kMessageNesting;
  return options;
}

constexpr unsigned kReady =
    kj::LowLevelAsyncIoProvider::ALREADY_CLOEXEC | kj::LowLevelAsyncIoProvider::ALREADY_NONBLOCK;

/// A duplicate of the accepted descriptor, owned by the caller, to be wrapped as the kind of socket that it
/// is.
kj::AutoCloseFd duplicate(const kj::AsyncIoStream& accepted) {
  KJ_IF_MAYBE (fd, accepted.getFd()) {
    return kj::AutoCloseFd(::fcntl(*fd, F_DUPFD_CLOEXEC, 0));
  }
  return nullptr;
}

}  // namespace

/// One connection, from accept to its end.
class Session {
 public:
  /// `secure` is the stream itself where that uses TLS, else null.
  Session(Sessions& owner, kj::Own<kj::AsyncCapabilityStream> stream, SecureStream* secure, Peer peer,
          std::string address)
      : owner_(owner),
        client_(std::make_shared<ClientState>()),
        place_(owner.table_.add(std::move(address), [this](const std::string& why) { cut_off(why); })),
        secure_(secure),
        stream_(kj::mv(stream), owner.timer_, secure != nullptr),
        cut_off_(kj::newPromiseAndFulfiller<void>()) {
    client_->peer = std::move(peer);
    if (secure_ == nullptr) serve();
    owner_.sessions_.push_back(this);
  }
  ~Session() noexcept { std::erase(owner_.sessions_, this); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Resolves when the client is gone or cut off, or has not said hello in time.
  kj::Promise<void> end() {
    auto late =
        owner_.timer_.afterDelay(to_kj(ConnectionTable::kTimeToEnter)).then([this]() -> kj::Promise<void> {
          if (place_.has_entered()) return kj::NEVER_DONE;
          refuse(rpc_.get() == nullptr ? "the TLS handshake was not done in time"
                                       : "it has not said hello in time");
          return kj::READY_NOW;
        });
    auto whole = secure_ == nullptr ? rpc_->network.onDisconnect() : enter();
    return whole
        .then([this] { note_fault("it has sent what is not a message, or too large a one"); },
              [this](kj::Exception&& exception) { note_fault(exception.getDescription().cStr()); })
        .exclusiveJoin(kj::mv(late))
        .exclusiveJoin(kj::mv(cut_off_.promise));
  }
  [[nodiscard]] bool idle() const {
    return client_->calls == 0 && client_->batches == 0 &&
           (rpc_.get() == nullptr || rpc_->network.getCurrentQueueCount() == 0);
  }

 private:
  struct Rpc {
    Rpc(Session& session, ServerCore& core)
        : messages(session.stream_, limits_of(kServerMessageWords)),
          network(messages, core.offered.kind().descriptors, capnp::rpc::twoparty::Side::SERVER,
                  limits_of(kClientMessageWords)),
          system(capnp::makeRpcServer(
              network, make_bootstrap(core, session.client_, [&session] { return session.come_in(); }))) {
      session.stream_.watch(network);
      system.setFlowLimit(kServerMessageWords);
    }
    BoundedReads messages;
    mutable capnp::TwoPartyVatNetwork network;
    capnp::RpcSystem<capnp::rpc::twoparty::VatId> system;
  };

  /// Lets end() resolve; only once. `why` is logged.
  void cut_off(const std::string& why) {
    refuse(why);
    cut_off_.fulfiller->fulfill();
  }
  /// Enters the client in the table of connections. All clients on this computer count as one person, since
  /// they are one user; others count by the name in their certificates.
  bool come_in() { return place_.enter(client_->peer.local ? std::string() : client_->peer.name); }

  void serve() { rpc_ = kj::heap<Rpc>(*this, owner_.core_); }

  /// The TLS handshake, then the service. A client that is refused gets the time to read why.
  kj::Promise<void> enter() {
    return secure_->handshake().then([this](Result<Identity>&& shown) -> kj::Promise<void> {
      if (!shown) {
        refuse(shown.error().message);
        return secure_->drain();
      }
      client_->peer.name = shown->name;
      client_->peer.role = shown->role;
      place_.identify(std::move(*shown));
      serve();
      return rpc_->network.onDisconnect();
    });
  }

  void refuse(const std::string& why) {
    if (std::exchange(refused_, true)) return;
    if (client_->peer.local) return log(LogLevel::Debug, "control", "cut off a local client: " + why);
    std::string who = to_string(client_->peer);
    if (client_->peer.name.empty() && !secure_->claimed_name().empty()) {
      who = "a client that calls itself " + quote(secure_->claimed_name()) + " at " + client_->peer.from;
    }
    owner_.core_.refusals.tell(who, why);
  }

  /// A session whose client has not closed it ends through a fault of the client, such as garbage.
  void note_fault(const std::string& what) {
    const auto problem = secure_ == nullptr ? std::nullopt : secure_->problem();
    if (problem) return refuse(problem->message);
    if (!stream_.has_ended()) refuse(what);
  }

  Sessions& owner_;
  std::shared_ptr<ClientState> client_;
  ConnectionTable::Place place_;
  SecureStream* secure_;
  GuardedStream stream_;
  kj::PromiseFulfillerPair<void> cut_off_;
  bool refused_ = false;
  kj::Own<Rpc> rpc_;
};

Sessions::Sessions(ServerCore& core, kj::AsyncIoContext& io, const Doors& doors)
    : core_(core),
      io_(*io.lowLevelProvider),
      timer_(io.provider->getTimer()),
      credentials_(doors.credentials),
      user_(doors.user),
      tasks_(*this) {
  if (doors.local >= 0) open(doors.local, true);
  if (doors.remote < 0) return;
  open(doors.remote, false);
  watching_ = watch().eagerlyEvaluate([this](kj::Exception&& exception) { taskFailed(kj::mv(exception)); });
}

Sessions::~Sessions() noexcept = default;

void Sessions::open(int socket, bool is_local) {
  auto door = kj::heap<Door>();
  door->receiver = io_.wrapListenSocketFd(socket, kj::LowLevelAsyncIoProvider::ALREADY_NONBLOCK);
  door->is_local = is_local;
  door->accepting =
      accept(*door).eagerlyEvaluate([this](kj::Exception&& exception) { taskFailed(kj::mv(exception)); });
  doors_.push_back(kj::mv(door));
}

void Sessions::stop_accepting() {
  for (auto& door : doors_)
    door->accepting = nullptr;
  doors_.clear();
}

bool Sessions::idle() const {
  return std::all_of(sessions_.begin(), sessions_.end(),
                     [](const Session* session) { return session->idle(); });
}

void Sessions::taskFailed(kj::Exception&& exception) {
  log(LogLevel::Debug, "control", exception.getDescription().cStr());
}

kj::Promise<void> Sessions::watch() {
  return timer_.afterDelay(to_kj(ConnectionTable::kWatchPeriod)).then([this] {
    table_.check(*credentials_);
    core_.refusals.settle();
    return watch();
  });
}

kj::Promise<void> Sessions::accept(Door& door) {
  return door.receiver->accept().then(
      [this, &door](kj::Own<kj::AsyncIoStream>&& stream) {
        door.is_local ? admit_local(*stream) : admit_remote(*stream);
        return accept(door);
      },
      [this, &door](kj::Exception&& exception) {  // there are no descriptors left: try again later
        log(LogLevel::Warning, "control",
            std::string("cannot accept a client: ") + exception.getDescription().cStr());
        return timer_.afterDelay(kAcceptPause).then([this, &door] { return accept(door); });
      });
}

void Sessions::admit_local(const kj::AsyncIoStream& accepted) {
  auto socket = duplicate(accepted);
  if (const auto trusted = check_peer(socket.get()); !trusted) {
    log(LogLevel::Warning, "control", "refused a client: " + trusted.error().message);
    return;
  }
  add(kj::heap<Session>(*this, io_.wrapUnixSocketFd(kj::mv(socket), kReady), nullptr,
                        Peer{user_, Role::Administer, {}, true}, std::string()));
}

void Sessions::admit_remote(const kj::AsyncIoStream& accepted) {
  auto socket = duplicate(accepted);
  if (socket.get() < 0) return;
  tune_tcp(socket.get());
  const TcpAddress address = peer_address(socket.get());
  auto stream = credentials_->encryption().accept(io_.wrapSocketFd(kj::mv(socket), kReady));
  SecureStream* secure = stream.get();
  add(kj::heap<Session>(*this, kj::mv(stream), secure, Peer{{}, Role::Observe, to_string(address), false},
                        address.host));
}

void Sessions::add(kj::Own<Session> session) {
  auto end = session->end();
  tasks_.add(end.attach(kj::mv(session)));
}

}  // namespace segue::control::detail
