// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/rpc/credentials.hpp>
#include <segue/rpc/peer.hpp>
#include <segue/web/files_verbs.hpp>
#include <segue/web/hub.hpp>
#include <segue/web/mission_starts.hpp>
#include <segue/web/page_files.hpp>
#include <segue/web/robot_link.hpp>
#include <segue/web/ros2_looks.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace segue::web {

using control::Role;

struct ServerOptions {
  std::uint16_t port = 0;            ///< 0: a free one
  std::string listen = "127.0.0.1";  ///< the address of this computer; "0.0.0.0" and "::": all it has
  /// With those of a host, browsers must show a person's certificate and get what it permits, over TLS;
  /// without any they bring a token, and only those of this computer reach the server.
  std::optional<control::Credentials> credentials{};
  Role role = Role::Administer;  ///< nobody gets more
  std::string robot{};           ///< its name, for the page
  Hub::Periods periods{};
  ModelsOf models{};          ///< for files that are edited; empty: no component is known
  RunMission run_mission{};   ///< empty: pages start no missions
  LookAtRos2 look_at_ros2{};  ///< empty: pages do not see ROS 2
  bool has_ros2 = false;      ///< pages offer that look, also for robots that have no components of ROS 2
  /// A browser has come in with the token; this address is for the next one. Called by the server's thread.
  std::function<void(const std::string& address)> entered{};
};

/// Serves a page and its WebSocket (at /socket) to browsers: one port, one thread. control::ConnectionTable
/// says which connections may stay; one comes in with its first request that Authenticator admits, and each
/// person, without certificates each browser, counts as one. Later requests have 10 s, 16 KiB of headers and
/// no body, messages 1 MiB. A person whose certificate is revoked is disconnected with the next message, or
/// within a second.
class Server {
 public:
  /// AlreadyExists where the port is taken; InvalidArgument where the address is none, or not of this
  /// computer alone though there are no credentials.
  static Result<std::unique_ptr<Server>> start(PageFiles page, const Connect& connect, ServerOptions options);
  /// Closes all connections; waits for calls of the robot in progress, until their deadlines at most.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  [[nodiscard]] std::uint16_t port() const;
  /// "http://127.0.0.1:PORT/?token=...", for one browser: a secret. With credentials "https://NAME:PORT/".
  [[nodiscard]] std::string address() const;

 private:
  struct Implementation;
  explicit Server(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::web
