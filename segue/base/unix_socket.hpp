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

/// 0, or the reason as errno. EAGAIN: the queue of the server is full.
int connect_once(int socket, const sockaddr_un& address);

/// A socket with mode 0600 that listens there, in place of whatever file is there: the caller knows that
/// nobody else serves it.
Result<Descriptor> listen_at(const std::filesystem::path& path);

}  // namespace segue
