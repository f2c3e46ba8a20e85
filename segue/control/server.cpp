// SPDX-License-Identifier: Apache-2.0
#include <segue/base/log.hpp>
#include <segue/control/detail/caller.hpp>
#include <segue/control/detail/session.hpp>
#include <segue/control/detail/socket.hpp>
#include <segue/control/server.hpp>

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

}  // namespace

struct Server::Implementation {
  Implementation(detail::ListeningSocket listening, Served service)
      : socket(std::move(listening)), core(service) {
    core.loop.run(
        [this](kj::AsyncIoContext& io) { sessions = std::make_unique<detail::Sessions>(core, io, socket); });
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
    core.batches.wait_for_none();
    close_sessions();
  }

  static Result<std::unique_ptr<Server>> start(detail::ListeningSocket listening, Served service) {
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
              on ? [this](const host::TaskEvent& event) { core.task_events.tell(event, core.loop); }
                 : deploy::DeploymentService::Listener());
    }
    if (auto* const* processes = std::get_if<process::ProcessService*>(&core.served)) {
      (*processes)
          ->set_listener(
              on ? [this](const process::ProcessInfo& event) { core.process_events.tell(event, core.loop); }
                 : process::ProcessService::Listener());
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

  detail::ListeningSocket socket;
  detail::ServerCore core;
  std::unique_ptr<detail::Sessions> sessions;  ///< belongs to the loop's thread
};

Server::Server(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}

Server::~Server() = default;

Result<std::unique_ptr<Server>> Server::listen(const std::filesystem::path& socket, Served service) {
  auto listening = detail::ListeningSocket::open(socket, RealClock::instance().now() + kSuccession);
  if (!listening) return listening.error();
  return Implementation::start(std::move(*listening), service);
}

Result<std::unique_ptr<Server>> Server::serve(Descriptor listening, Served service) {
  auto adopted = detail::ListeningSocket::adopt(std::move(listening));
  if (!adopted) return adopted.error();
  return Implementation::start(std::move(*adopted), service);
}

}  // namespace segue::control
