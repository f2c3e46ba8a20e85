// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/robot.capnp.h>
#include <segue/base/result.hpp>
#include <segue/control/detail/event_loop.hpp>
#include <segue/control/detail/worker_pool.hpp>
#include <segue/control/robot_service.hpp>

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>

/// The server's half of the schema: RobotService offered to one client. Everything here lives in the server's
/// event loop, but service calls, which run on the pool's threads.
namespace segue::control::detail {

/// What all clients of a server share.
struct ServerCore {
  static constexpr std::size_t kMaxCalls = 64;

  explicit ServerCore(RobotService& robot) : service(robot) {}

  RobotService& service;
  std::atomic<bool> stopping{false};
  EventLoop loop;
  WorkerPool pool{kMaxCalls};  ///< goes before the loop, to which its jobs post
};

/// What all capabilities of a client share; outlives the connection while calls are in progress.
struct ClientState {
  bool greeted = false;
  std::size_t calls = 0;
  std::size_t streams = 0;
};

/// Runs service calls of one client. Not for use outside the event loop.
class Caller {
 public:
  using Job = std::function<Result<type::Value>()>;

  Caller(ServerCore& core, std::shared_ptr<ClientState> client) : core_(core), client_(std::move(client)) {}

  /// Runs `job` on a thread of the pool. ResourceExhausted where too many calls are in progress. Exceptions
  /// of `job` become errors.
  kj::Promise<Result<type::Value>> run(Job job);
  /// run(), and the outcome into the call's results.
  template <class Context>
  kj::Promise<void> answer(Context context, Job job);

  [[nodiscard]] ServerCore& core() const { return core_; }
  [[nodiscard]] RobotService& service() const { return core_.service; }
  [[nodiscard]] const std::shared_ptr<ClientState>& client() const { return client_; }

 private:
  ServerCore& core_;
  std::shared_ptr<ClientState> client_;
};

/// The capability a client gets for its hello.
wire::Robot::Client make_robot_server(ServerCore& core, std::shared_ptr<ClientState> client);

}  // namespace segue::control::detail
