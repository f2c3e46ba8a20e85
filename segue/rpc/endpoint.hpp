// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rpc/credentials.hpp>
#include <segue/rpc/tcp_address.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <variant>

namespace segue::control {

/// A server on another computer, or on this one through the network.
struct TcpEndpoint {
  TcpAddress address;
  std::string host;  ///< the name that the server's certificate must have
  Credentials credentials;
};

/// Where a client finds a server: a Unix socket, or TCP with mutual TLS.
using Endpoint = std::variant<std::filesystem::path, TcpEndpoint>;

/// Where a server listens on TCP. Only addresses, no names: "0.0.0.0" or "::" is every interface. Port 0 is
/// any that is free (Server::port()).
struct TcpPlace {
  TcpAddress address;
  Credentials credentials;  ///< of a host
};

/// Where a server listens: on a Unix socket, on TCP, or on both.
struct Places {
  std::filesystem::path socket;  ///< empty: none
  std::optional<TcpPlace> tcp;
};

}  // namespace segue::control
