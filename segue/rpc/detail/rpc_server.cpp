// SPDX-License-Identifier: Apache-2.0
#include <segue/base/log.hpp>
#include <segue/base/text.hpp>
#include <segue/rpc/detail/caller.hpp>
#include <segue/rpc/detail/rpc_server.hpp>
#include <segue/rpc/detail/server_sessions.hpp>
#include <segue/rpc/detail/socket.hpp>
#include <segue/rpc/detail/tcp_socket.hpp>

#include <pwd.h>
#include <unistd.h>

#include <array>
#include <exception>
#include <optional>
#include <string>
#include <utility>

namespace segue::control::detail {

namespace {

/// How long a predecessor that was killed may take to end.
constexpr auto kSuccession = std::chrono::seconds(10);
constexpr auto kFlushPoll = std::chrono::milliseconds(5);
constexpr auto kFlushLimit = std::chrono::milliseconds(500);

/// The sockets of a server.
struct Listening {
  std::optional<ListeningSocket> local;
  Descriptor remote;
  std::optional<Credentials> credentials;
  std::string user;
};

/// The name of this program's user; the number where it has none.
std::string user_name() {
  std::array<char, 4096> buffer{};
  passwd entry{};
  passwd* found = nullptr;
  ::getpwuid_r(::geteuid(), &entry, buffer.data(), buffer.size(), &found);
  return found != nullptr ? std::string(found->pw_name) : std::to_string(::geteuid());
}

/// The name that clients of the Unix socket get. Looking it up may take a while; a process that exchanges
/// descriptors has one client, and starts as quickly as it can.
std::string user_who_asks(const OfferedService& service) {
  return service.kind().descriptors > 0 ? std::string() : user_name();
}

Result<void> listen_on_tcp(Listening& listening, const TcpPlace& place, const ServiceKind& kind) {
  if (kind.descriptors > 0) {
    return fail(ErrorCode::Unsupported,
                std::string(kind.noun) + " cannot be served on TCP: it exchanges file descriptors");
  }
  if (!place.credentials.identity().host) {
    return fail(ErrorCode::InvalidArgument, "the certificate of " + quote(place.credentials.name()) +
                                                " is not that of a host; enrol it with --host");
  }
  auto socket = listen_tcp(place.address);
  if (!socket) return socket.error();
  listening.remote = std::move(*socket);
  listening.credentials = place.credentials;
  return {};
}

}  // namespace

struct RpcServer::Implementation {
  Implementation(Listening listening, std::unique_ptr<OfferedService> service)
      : sockets(std::move(listening)), offered(std::move(service)), core(*offered) {
    core.loop.run([this](kj::AsyncIoContext& io) {
      const Doors doors{sockets.local ? sockets.local->descriptor() : -1, sockets.remote.get(),
                        sockets.credentials, sockets.user};
      sessions = std::make_unique<Sessions>(core, io, doors);
    });
    offered->report_events(&core.loop);
  }

  /// Calls in progress end first, since the service may be gone afterwards; their answers are still sent.
  ~Implementation() {
    core.stopping = true;
    offered->report_events(nullptr);
    core.loop.post([this](kj::AsyncIoContext&) {
      if (sessions) sessions->stop_accepting();
    });
    core.pool.close();
    core.urgent_pool.close();
    core.batches.wait_for_none();
    close_sessions();
    core.watches.wait_for_none();
  }

  static Result<std::unique_ptr<RpcServer>> start(Listening listening,
                                                  std::unique_ptr<OfferedService> service) {
    try {
      auto implementation = std::make_unique<Implementation>(std::move(listening), std::move(service));
      if (!implementation->sessions) return fail(ErrorCode::Internal, "the control server did not start");
      return std::unique_ptr<RpcServer>(new RpcServer(std::move(implementation)));
    } catch (const std::exception& exception) {
      return fail(ErrorCode::ResourceExhausted,
                  std::string("the control server cannot start: ") + exception.what());
    }
  }

  /// Once no answer waits to be sent any more, or is not taken in time.
  void close_sessions() {
    auto& clock = RealClock::instance();
    const TimePoint give_up = clock.now() + kFlushLimit;
    for (bool closed = false; !closed;) {
      core.loop.run([&](kj::AsyncIoContext&) {
        closed = !sessions || sessions->idle() || clock.now() >= give_up;
        if (closed) sessions.reset();
      });
      if (!closed) clock.sleep_until(clock.now() + kFlushPoll);
    }
  }

  Listening sockets;
  const std::unique_ptr<OfferedService> offered;
  ServerCore core;
  std::unique_ptr<Sessions> sessions;  ///< belongs to the loop's thread
};

RpcServer::RpcServer(std::unique_ptr<Implementation> implementation)
    : implementation_(std::move(implementation)) {}

RpcServer::~RpcServer() = default;

std::uint16_t RpcServer::port() const {
  return implementation_->sockets.remote.valid() ? port_of(implementation_->sockets.remote.get()) : 0;
}

Result<std::unique_ptr<RpcServer>> RpcServer::listen(const Places& places,
                                                     std::unique_ptr<OfferedService> service) {
  Listening listening;
  if (places.tcp) {
    if (auto done = listen_on_tcp(listening, *places.tcp, service->kind()); !done) return done.error();
  }
  if (!places.socket.empty()) {
    auto local = ListeningSocket::open(places.socket, RealClock::instance().now() + kSuccession);
    if (!local) return local.error();
    listening.local.emplace(std::move(*local));
  }
  if (!listening.local && !listening.remote.valid()) {
    return fail(ErrorCode::InvalidArgument, "the server has neither a socket nor an address to listen at");
  }
  listening.user = user_who_asks(*service);
  return Implementation::start(std::move(listening), std::move(service));
}

Result<std::unique_ptr<RpcServer>> RpcServer::serve(Descriptor listening,
                                                    std::unique_ptr<OfferedService> service) {
  auto adopted = ListeningSocket::adopt(std::move(listening));
  if (!adopted) return adopted.error();
  Listening sockets;
  sockets.local.emplace(std::move(*adopted));
  sockets.user = user_who_asks(*service);
  return Implementation::start(std::move(sockets), std::move(service));
}

}  // namespace segue::control::detail
