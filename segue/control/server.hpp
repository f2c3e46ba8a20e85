// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>
#include <segue/control/robot_service.hpp>
#include <segue/rpc/endpoint.hpp>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <stop_token>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace segue::deploy {
class DeploymentService;
}
namespace segue::process_server {
class ProcessService;
}
namespace segue::distributed {
class HostService;
}

namespace segue::control {

namespace detail {
class RpcServer;
}

/// `$XDG_RUNTIME_DIR/segue`, else `/tmp/segue-UID`; made with mode 0700 and refused if it belongs to somebody
/// else.
Result<std::filesystem::path> socket_folder();
/// The socket of the robot of that name.
Result<std::filesystem::path> socket_path(std::string_view robot);
/// The socket of this computer's daemon (`segue host`), which serves HostService.
Result<std::filesystem::path> daemon_socket();
/// Names of robots whose sockets answer, sorted. Removes sockets without a server.
std::vector<std::string> running_robots();

/// The service that a server offers; never null. The server sets the one listener of a deployment or process
/// service.
using Served = std::variant<RobotService*, deploy::DeploymentService*, process_server::ProcessService*,
                            distributed::HostService*>;

/// Serves one service from a thread of its own: on a Unix socket (0600; the peer's uid must be ours or
/// root's; clients there administer), and on TCP with mutual TLS, where the client's certificate says what it
/// may do (Role). Service calls run side by side on up to 64 threads, so a slow one delays nobody; what is
/// beyond the limits (those of ConnectionTable for connections, where hello is how a client comes in; 16
/// calls at once and 256 open ports for each client, messages of 8 MiB) is refused with ResourceExhausted or
/// closed. A person who may only observe has 16 calls at once on all connections together, and all observers
/// have 48, so that threads are left for those who operate. Refusals of clients from other computers are
/// logged, with who, from where and why; at most one a second where they are many. A client whose certificate
/// is revoked (ca.crl of the credentials is watched) or expires is disconnected within a second. Events of
/// the service are reported to the clients that listen; one that does not keep up loses the oldest and learns
/// how many.
class Server {
 public:
  /// AlreadyExists where a living server holds the socket; a stale one is replaced.
  static Result<std::unique_ptr<Server>> listen(const std::filesystem::path& socket, Served service);
  /// Listens at several places. AlreadyExists also where the port is taken; Unsupported for a deployment
  /// process on TCP, since it needs descriptors; InvalidArgument where there is no place, the address is not
  /// numeric or the credentials are not those of a host.
  static Result<std::unique_ptr<Server>> listen(const Places& places, Served service);
  /// Serves on a socket that is bound and listens already; its file is not removed at the end.
  /// InvalidArgument where it is no such socket.
  static Result<std::unique_ptr<Server>> serve(Descriptor listening, Served service);
  /// Refuses new calls, waits for those in progress (until their deadlines at most) and sends their answers,
  /// then closes all clients and removes the socket that listen() made.
  ~Server();

  /// The port of TCP; 0 where it does not listen there.
  [[nodiscard]] std::uint16_t port() const;

 private:
  explicit Server(std::unique_ptr<detail::RpcServer> server);
  const std::unique_ptr<detail::RpcServer> server_;
};

/// The robot at that place. Unavailable where nobody answers; calls after the robot went answer Unavailable
/// too. On TCP also NotFound where the computer's name is unknown, DeadlineExceeded where it does not answer,
/// and PermissionDenied where one side refuses the certificate of the other; the message says which and why.
/// The destructor closes. Cancelled, on a Unix socket, once a stop is requested.
Result<std::unique_ptr<RobotService>> connect(const Endpoint& endpoint,
                                              Duration timeout = std::chrono::seconds(5),
                                              const std::stop_token& stop = {});

}  // namespace segue::control
