// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>
#include <segue/control/robot_service.hpp>

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace segue::deploy {
class DeploymentService;
}
namespace segue::process {
class ProcessService;
}
namespace segue::hosts {
class HostService;
}

namespace segue::control {

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
using Served =
    std::variant<RobotService*, deploy::DeploymentService*, process::ProcessService*, hosts::HostService*>;

/// Serves one service on a Unix socket (0600; the peer's uid must be ours or root's) from a thread of its
/// own. Service calls run side by side on up to 64 threads, so a slow one delays nobody; what is beyond the
/// limits (64 clients, 16 calls at once and 256 open ports for each, messages of 8 MiB) is refused with
/// ResourceExhausted. Events of the service are reported to the clients that listen; one that does not keep
/// up loses the oldest and learns how many.
class Server {
 public:
  /// AlreadyExists where a living server holds the socket; a stale one is replaced.
  static Result<std::unique_ptr<Server>> listen(const std::filesystem::path& socket, Served service);
  /// Serves on a socket that is bound and listens already; its file is not removed at the end.
  /// InvalidArgument where it is no such socket.
  static Result<std::unique_ptr<Server>> serve(Descriptor listening, Served service);
  /// Refuses new calls, waits for those in progress (until their deadlines at most) and sends their answers,
  /// then closes all clients and removes the socket that listen() made.
  ~Server();

 private:
  struct Implementation;
  explicit Server(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

/// The robot on the other end of a socket. Unavailable where nobody answers; calls after the robot went
/// answer Unavailable too. The destructor closes.
Result<std::unique_ptr<RobotService>> connect(const std::filesystem::path& socket,
                                              Duration timeout = std::chrono::seconds(5));

}  // namespace segue::control
