// SPDX-License-Identifier: Apache-2.0
#include <segue/base/log.hpp>
#include <segue/base/text.hpp>
#include <segue/control/detail/caller.hpp>
#include <segue/control/detail/server_sessions.hpp>
#include <segue/control/detail/socket.hpp>
#include <segue/control/detail/tcp_socket.hpp>
#include <segue/control/server.hpp>

#include <pwd.h>
#include <unistd.h>

#include <array>
#include <exception>
#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace segue::control {

namespace {

/// How long a predecessor that was killed may take to end.
constexpr auto kSuccession = std::chrono::seconds(10);
constexpr auto kFlushPoll = std::chrono::milliseconds(5);
constexpr auto kFlushLimit = std::chrono::milliseconds(500);

/// The sockets of a server.
struct Listening {
  std::optional<detail::ListeningSocket> local;
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

bool is_deployment(const Served& service) {
  return std::holds_alternative<deploy::DeploymentService*>(service);
}

Result<void> listen_on_tcp(Listening& listening, const TcpPlace& place, const Served& service) {
  if (is_deployment(service)) {
    return fail(ErrorCode::Unsupported,
                "a deployment process cannot be served on TCP: it exchanges file descriptors");
  }
  if (!place.credentials.identity().host) {
    return fail(ErrorCode::InvalidArgument, "the certificate of " + quote(place.credentials.name()) +
                                                " is not that of a host; enrol it with --host");
  }
  auto socket = detail::listen_tcp(place.address);
  if (!socket) return socket.error();
  listening.remote = std::move(*socket);
  listening.credentials = place.credentials;
  return {};
}

}  // namespace

struct Server::Implementation {
  Implementation(Listening listening, Served service) : sockets(std::move(listening)), core(service) {
    core.loop.run([this](kj::AsyncIoContext& io) {
      const detail::Doors doors{sockets.local ? sockets.local->descriptor() : -1, sockets.remote.get(),
                                sockets.credentials, sockets.user};
      sessions = std::make_unique<detail::Sessions>(core, io, doors);
    });
    listen_to_service(true);
  }

  /// Calls in progress end first, since the service may be gone afterwards; their answers are still sent.
  ~Implementation() {
    core.stopping = true;
    listen_to_service(false);
    core.loop.post([this](kj::AsyncIoContext&) {
      if (sessions) sessions->stop_accepting();
    });
    core.pool.close();
    core.urgent_pool.close();
    core.batches.wait_for_none();
    close_sessions();
    core.watches.wait_for_none();
  }

  static Result<std::unique_ptr<Server>> start(Listening listening, Served service) {
    try {
      auto implementation = std::make_unique<Implementation>(std::move(listening), service);
      if (!implementation->sessions) return fail(ErrorCode::Internal, "the control server did not start");
      return std::unique_ptr<Server>(new Server(std::move(implementation)));
    } catch (const std::exception& exception) {
      return fail(ErrorCode::ResourceExhausted,
                  std::string("the control server cannot start: ") + exception.what());
    }
  }

  void listen_to_service(bool on) {
    if (auto* const* deployment = std::get_if<deploy::DeploymentService*>(&core.served)) {
      (*deployment)
          ->set_listener(
              on ? [this](const task_host::TaskEvent& event) { core.task_events.tell(event, core.loop); }
                 : deploy::DeploymentService::Listener());
    }
    if (auto* const* processes = std::get_if<process_server::ProcessService*>(&core.served)) {
      (*processes)
          ->set_listener(on ? [this](const process_server::ProcessInfo&
                                         event) { core.process_events.tell(event, core.loop); }
                            : process_server::ProcessService::Listener());
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
  detail::ServerCore core;
  std::unique_ptr<detail::Sessions> sessions;  ///< belongs to the loop's thread
};

Server::Server(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}

Server::~Server() = default;

std::uint16_t Server::port() const {
  return implementation_->sockets.remote.valid() ? detail::port_of(implementation_->sockets.remote.get()) : 0;
}

Result<std::unique_ptr<Server>> Server::listen(const std::filesystem::path& socket, Served service) {
  return listen(Places{socket, std::nullopt}, service);
}

Result<std::unique_ptr<Server>> Server::listen(const Places& places, Served service) {
  Listening listening;
  if (places.tcp) {
    if (auto done = listen_on_tcp(listening, *places.tcp, service); !done) return done.error();
  }
  if (!places.socket.empty()) {
    auto local = detail::ListeningSocket::open(places.socket, RealClock::instance().now() + kSuccession);
    if (!local) return local.error();
    listening.local.emplace(std::move(*local));
  }
  if (!listening.local && !listening.remote.valid()) {
    return fail(ErrorCode::InvalidArgument, "the server has neither a socket nor an address to listen at");
  }
  // Looking it up may take a while, and a deployment process starts as quickly as it can.
  if (!is_deployment(service)) listening.user = user_name();
  return Implementation::start(std::move(listening), service);
}

Result<std::unique_ptr<Server>> Server::serve(Descriptor listening, Served service) {
  auto adopted = detail::ListeningSocket::adopt(std::move(listening));
  if (!adopted) return adopted.error();
  Listening sockets;
  sockets.local.emplace(std::move(*adopted));
  if (!is_deployment(service)) sockets.user = user_name();
  return Implementation::start(std::move(sockets), service);
}

}  // namespace segue::control
