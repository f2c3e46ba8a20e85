// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>

#include <sys/socket.h>
#include <sys/un.h>

#include <filesystem>

/// Unix stream sockets, close-on-exec and non-blocking. All functions may be called from any thread.
namespace segue {

/// InvalidArgument where the path is longer than the system allows.
Result<sockaddr_un> socket_address(const std::filesystem::path& path);

/// A socket without a name.
Result<Descriptor> new_socket();

/// Connects without waiting. Returns 0 or an errno; EAGAIN: the server's queue is full.
int connect_once(int socket, const sockaddr_un& address);

/// A listening socket with mode 0600 at `path`, replacing any file there. Requires that the caller knows that
/// nobody else serves it.
Result<Descriptor> listen_at(const std::filesystem::path& path);

}  // namespace segue
