// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/control/detail/socket.hpp>

#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>
#include <string>
#include <system_error>

namespace segue::control::detail {

namespace {

constexpr int kBacklog = 64;
constexpr mode_t kOwnerOnly = 0600;

Error system_error(const std::string& what, int number) {
  const auto code = number == EACCES || number == EPERM    ? ErrorCode::PermissionDenied
                    : number == EMFILE || number == ENFILE ? ErrorCode::ResourceExhausted
                                                           : ErrorCode::IoError;
  return fail(code, what + ": " + std::generic_category().message(number));
}

Result<sockaddr_un> address_of(const std::filesystem::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string& text = path.native();
  if (text.size() >= sizeof address.sun_path) {
    return fail(ErrorCode::InvalidArgument,
                "the path of the socket " + quote(text) + " is longer than the " +
                    std::to_string(sizeof address.sun_path - 1) +
                    " bytes that the system allows; set XDG_RUNTIME_DIR to a folder with a shorter path");
  }
  std::copy(text.begin(), text.end(), address.sun_path);
  return address;
}

std::filesystem::path lock_path(const std::filesystem::path& socket) {
  return std::filesystem::path(socket) += ".lock";
}

bool is_file_at(int descriptor, const std::filesystem::path& path) {
  struct stat mine {};
  struct stat there {};
  return ::fstat(descriptor, &mine) == 0 && ::stat(path.c_str(), &there) == 0 &&
         mine.st_ino == there.st_ino && mine.st_dev == there.st_dev;
}

/// Nothing where somebody else has the lock. A lock that its last owner removed while we waited for it is no
/// lock, hence the loop.
Result<std::optional<Descriptor>> try_lock(const std::filesystem::path& path) {
  for (;;) {
    Descriptor file(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, kOwnerOnly));
    if (!file.valid()) return system_error("cannot open the lock " + quote(path.native()), errno);
    if (::flock(file.get(), LOCK_EX | LOCK_NB) != 0) {
      if (errno == EWOULDBLOCK) return std::optional<Descriptor>{};
      return system_error("cannot lock " + quote(path.native()), errno);
    }
    if (is_file_at(file.get(), path)) return std::optional<Descriptor>(std::move(file));
  }
}

Result<Descriptor> new_socket() {
  Descriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!socket.valid()) return system_error("cannot make a socket", errno);
  return socket;
}

/// 0, or the reason. EAGAIN: the server's queue is full.
int connect_once(int socket, const sockaddr_un& address) {
  const auto* raw = reinterpret_cast<const sockaddr*>(&address);
  return ::connect(socket, raw, sizeof address) == 0 ? 0 : errno;
}

bool somebody_listens(const sockaddr_un& address) {
  const auto socket = new_socket();
  if (!socket) return true;
  const int reason = connect_once(socket->get(), address);
  return reason != ECONNREFUSED && reason != ENOENT;
}

Error already_served(const std::filesystem::path& path) {
  return fail(ErrorCode::AlreadyExists, "another program serves " + quote(path.native()) +
                                            "; stop it first, or give this robot another name");
}

Result<Descriptor> bind_socket(const std::filesystem::path& path, const sockaddr_un& address) {
  auto socket = new_socket();
  if (!socket) return socket;
  const auto* raw = reinterpret_cast<const sockaddr*>(&address);
  if (::bind(socket->get(), raw, sizeof address) != 0) {
    return system_error("cannot make the socket " + quote(path.native()), errno);
  }
  // Nobody can connect before listen(), so the mode is right before it matters.
  if (::chmod(path.c_str(), kOwnerOnly) != 0 || ::listen(socket->get(), kBacklog) != 0) {
    const int reason = errno;
    ::unlink(path.c_str());
    return system_error("cannot listen on " + quote(path.native()), reason);
  }
  return socket;
}

}  // namespace

ListeningSocket::ListeningSocket(std::filesystem::path path, Descriptor lock, Descriptor socket)
    : path_(std::move(path)), lock_(std::move(lock)), socket_(std::move(socket)) {}

Result<ListeningSocket> ListeningSocket::open(const std::filesystem::path& path) {
  const auto address = address_of(path);
  if (!address) return address.error();
  auto lock = try_lock(lock_path(path));
  if (!lock) return lock.error();
  if (!lock->has_value()) return already_served(path);
  if (somebody_listens(*address)) return already_served(path);
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) {
    return system_error("cannot remove the stale socket " + quote(path.native()), errno);
  }
  auto socket = bind_socket(path, *address);
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
                "descriptor " + std::to_string(socket.get()) + " is no Unix socket that listens");
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
  ::unlink(lock_path(path_).c_str());
}

bool remove_if_stale(const std::filesystem::path& path) {
  const auto address = address_of(path);
  if (!address) return false;
  if (somebody_listens(*address)) return false;
  const auto lock = try_lock(lock_path(path));
  if (!lock || !lock->has_value()) return false;  // somebody is about to listen
  if (somebody_listens(*address)) return false;
  ::unlink(path.c_str());
  ::unlink(lock_path(path).c_str());
  return true;
}

Result<void> check_peer(int socket) {
  ucred peer{};
  socklen_t size = sizeof peer;
  if (::getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) {
    return system_error("cannot tell who is at the other end of the socket", errno);
  }
  if (peer.uid == ::geteuid() || peer.uid == 0) return {};
  return fail(ErrorCode::PermissionDenied, "the other end of the socket runs as user " +
                                               std::to_string(peer.uid) + ", not as user " +
                                               std::to_string(::geteuid()));
}

Result<Descriptor> connect_socket(const std::filesystem::path& path, Duration timeout) {
  const auto address = address_of(path);
  if (!address) return address.error();
  auto socket = new_socket();
  if (!socket) return socket;
  const TimePoint give_up = RealClock::instance().now() + timeout;
  int reason = connect_once(socket->get(), *address);
  while (reason == EAGAIN && RealClock::instance().now() < give_up) {
    RealClock::instance().sleep_until(RealClock::instance().now() + std::chrono::milliseconds(5));
    reason = connect_once(socket->get(), *address);
  }
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
