// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <cstdint>
#include <string>
#include <string_view>

namespace segue::control {

/// Where a server listens: a computer and a port.
struct TcpAddress {
  std::string host;  ///< an IPv4 or IPv6 address without brackets, or a name for the resolver
  std::uint16_t port = 0;
  friend bool operator==(const TcpAddress&, const TcpAddress&) = default;
};

/// "10.0.0.3:7000", "[fe80::1%eth0]:7000", "left.local:7000". Without a port it is `default_port`;
/// InvalidArgument where that is 0, too, or where the text is not an address.
Result<TcpAddress> parse_tcp_address(std::string_view text, std::uint16_t default_port = 0);

/// The address as parse_tcp_address() reads it: "10.0.0.3:7000".
std::string to_string(const TcpAddress& address);

}  // namespace segue::control
