// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>
#include <segue/rpc/tcp_address.hpp>

#include <cstdint>
#include <string>

/// TCP sockets, close-on-exec and non-blocking: the parts of server and client that do not depend on Cap'n
/// Proto.
namespace segue::control::detail {

/// Listens. AlreadyExists where the port is taken; InvalidArgument where the host is not a numeric address.
Result<Descriptor> listen_tcp(const TcpAddress& address);

/// Connects to the first address of the host that answers; a name is looked up by a thread of its own, which
/// is left to itself where the resolver does not answer in time. Blocks. Unavailable where nobody listens or
/// no route leads there, NotFound where the name is unknown, DeadlineExceeded where nothing answers until
/// then.
Result<Descriptor> connect_tcp(const TcpAddress& address, TimePoint deadline);

/// Sends at once (TCP_NODELAY), and notices within 20 s that the other computer is gone (keepalive,
/// TCP_USER_TIMEOUT).
void tune_tcp(int socket);

/// The port that a socket is bound to; 0 where it has none.
std::uint16_t port_of(int socket);
/// The other end of a socket; empty where it is not known.
TcpAddress peer_address(int socket);

}  // namespace segue::control::detail
