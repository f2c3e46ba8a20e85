// SPDX-License-Identifier: Apache-2.0
#include <segue/base/error.hpp>
#include <segue/base/lock_file.hpp>
#include <segue/base/process_state.hpp>
#include <segue/base/text.hpp>
#include <segue/base/unix_socket.hpp>
#include <segue/rpc/detail/socket.hpp>

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <optional>
#include <string>

namespace segue::control::detail {

namespace {

/// Time between two attempts to reach a server that is ending or busy.
constexpr auto kPause = std::chrono::milliseconds(5);

Error already_served(const std::filesystem::path& path) {
  return fail(ErrorCode::AlreadyExists, "another program serves " + quote(path.native()) +
                                            "; stop it first, or give this robot another name");
}

Result<ucred> peer_of(int socket) {
  ucred peer{};
  socklen_t size = sizeof peer;
  if (::getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) {
    return system_error("cannot tell who is at the other end of the socket", errno);
  }
  return peer;
}

/// The process id of the server: 0 where it cannot be determined, nothing where no process listens.
std::optional<int> listener_at(const sockaddr_un& address) {
  const auto socket = new_socket();
  if (!socket) return 0;
  const int reason = connect_once(socket->get(), address);
  if (reason == ECONNREFUSED || reason == ENOENT) return std::nullopt;
  const auto peer = peer_of(socket->get());
  return reason == 0 && peer ? peer->pid : 0;
}

bool goes(int pid) {
  return is_ending(pid) || (::kill(pid, 0) != 0 && errno == ESRCH);
}

/// Whether a server without a lock has the socket, or one whose lock has been released already. Waits for one
/// that is ending.
bool somebody_listens(const sockaddr_un& address, TimePoint deadline) {
  while (const auto pid = listener_at(address)) {
    if (*pid == 0 || !goes(*pid) || RealClock::instance().now() >= deadline) return true;
    RealClock::instance().sleep_until(RealClock::instance().now() + kPause);
  }
  return false;
}

}  // namespace

ListeningSocket::ListeningSocket(std::filesystem::path path, Descriptor lock, Descriptor socket)
    : path_(std::move(path)), lock_(std::move(lock)), socket_(std::move(socket)) {}

Result<ListeningSocket> ListeningSocket::open(const std::filesystem::path& path, TimePoint deadline) {
  const auto address = socket_address(path);
  if (!address) return address.error();
  auto lock = lock_when_ended(lock_of(path), deadline);
  if (!lock) return lock.error();
  if (!lock->has_value() || somebody_listens(*address, deadline)) return already_served(path);
  // Where the process id cannot be written, a successor does not wait for our end; nothing else depends on
  // it.
  static_cast<void>(write_record((*lock)->get(), {::getpid(), SEGUE_VERSION}));
  auto socket = listen_at(path);
  if (!socket) return socket.error();
  return ListeningSocket(path, std::move(**lock), std::move(*socket));
}

Result<ListeningSocket> ListeningSocket::adopt(Descriptor socket) {
  int family = 0;
  int listens = 0;
  socklen_t size = sizeof family;
  if (::getsockopt(socket.get(), SOL_SOCKET, SO_DOMAIN, &family, &size) != 0 || family != AF_UNIX ||
      ::getsockopt(socket.get(), SOL_SOCKET, SO_ACCEPTCONN, &listens, &size) != 0 || listens == 0) {
    return fail(ErrorCode::InvalidArgument,
                "descriptor " + std::to_string(socket.get()) + " is not a Unix socket that listens");
  }
  const int flags = ::fcntl(socket.get(), F_GETFL);
  if (flags < 0 || ::fcntl(socket.get(), F_SETFL, flags | O_NONBLOCK) != 0 ||
      ::fcntl(socket.get(), F_SETFD, FD_CLOEXEC) != 0) {
    return system_error("cannot use the inherited socket", errno);
  }
  return ListeningSocket({}, Descriptor(), std::move(socket));
}

ListeningSocket::~ListeningSocket() {
  if (!lock_.valid()) return;  // moved from, or not ours to remove
  ::unlink(path_.c_str());
  ::unlink(lock_of(path_).c_str());
}

bool remove_if_stale(const std::filesystem::path& path) {
  const auto address = socket_address(path);
  if (!address) return false;
  if (listener_at(*address)) return false;
  const auto lock = try_lock(lock_of(path));
  if (!lock || !lock->has_value()) return false;  // another server is about to listen
  if (listener_at(*address)) return false;
  ::unlink(path.c_str());
  ::unlink(lock_of(path).c_str());
  return true;
}

Result<void> check_peer(int socket) {
  const auto peer = peer_of(socket);
  if (!peer) return peer.error();
  if (peer->uid == ::geteuid() || peer->uid == 0) return {};
  return fail(ErrorCode::PermissionDenied, "the other end of the socket runs as user " +
                                               std::to_string(peer->uid) + ", not as user " +
                                               std::to_string(::geteuid()));
}

Result<Descriptor> connect_socket(const std::filesystem::path& path, const Wait& wait) {
  const auto address = socket_address(path);
  if (!address) return address.error();
  auto socket = new_socket();
  if (!socket) return socket;
  int reason = connect_once(socket->get(), *address);
  while (reason == EAGAIN && RealClock::instance().now() < wait.deadline && !wait.is_stopped()) {
    RealClock::instance().sleep_until(RealClock::instance().now() + kPause);
    reason = connect_once(socket->get(), *address);
  }
  if (reason == EAGAIN && wait.is_stopped()) return no_longer_wanted();
  if (reason == EAGAIN) {
    return fail(ErrorCode::Unavailable,
                "the program at " + quote(path.native()) + " does not take new clients");
  }
  if (reason == ENOENT || reason == ECONNREFUSED) {
    return fail(ErrorCode::Unavailable, "nobody answers at " + quote(path.native()));
  }
  if (reason != 0) return system_error("cannot connect to " + quote(path.native()), reason);
  const auto peer = check_peer(socket->get());
  if (!peer) return peer.error();
  return socket;
}

}  // namespace segue::control::detail
