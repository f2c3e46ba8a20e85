// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/concurrent/thread.hpp>
#include <segue/rpc/detail/tcp_socket.hpp>

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <future>
#include <memory>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

namespace segue::control::detail {

namespace {

constexpr int kBacklog = 1024;
/// Seconds without a sign of life after which the other side is asked for one, how often, and how far apart.
constexpr int kKeepIdle = 8;
constexpr int kKeepCount = 3;
constexpr int kKeepInterval = 4;
/// Milliseconds after which data that nobody has confirmed counts as lost.
constexpr int kUserTimeout = 20'000;

struct SocketAddress {
  sockaddr_storage storage{};
  socklen_t size = 0;
  [[nodiscard]] const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&storage); }
};

struct Resolved {
  int status = 0;  ///< of getaddrinfo
  std::vector<SocketAddress> addresses;
};

Resolved resolve(const TcpAddress& address, int flags) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = flags | AI_NUMERICSERV;
  addrinfo* list = nullptr;
  Resolved result;
  result.status = ::getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &hints, &list);
  if (result.status != 0) return result;
  for (const addrinfo* one = list; one != nullptr; one = one->ai_next) {
    SocketAddress socket;
    if (one->ai_addrlen > sizeof socket.storage) continue;
    std::copy_n(reinterpret_cast<const char*>(one->ai_addr), one->ai_addrlen,
                reinterpret_cast<char*>(&socket.storage));
    socket.size = one->ai_addrlen;
    result.addresses.push_back(socket);
  }
  ::freeaddrinfo(list);
  return result;
}

Error no_answer(const TcpAddress& address) {
  return fail(ErrorCode::DeadlineExceeded,
              quote(to_string(address)) + " did not answer in time; is the computer on, and the port open?");
}

/// Nobody can stop the resolver of the system, which may wait for its servers for a minute.
Result<std::vector<SocketAddress>> resolve_until(const TcpAddress& address, TimePoint deadline) {
  Resolved resolved = resolve(address, AI_NUMERICHOST);
  if (resolved.status == EAI_NONAME) {
    const auto done = std::make_shared<std::promise<Resolved>>();
    auto answer = done->get_future();
    try {
      concurrent::start_thread("segue-resolve", [done, address] {
        done->set_value(resolve(address, AI_ADDRCONFIG));
      }).detach();
    } catch (const std::system_error&) {
      return fail(ErrorCode::ResourceExhausted, "there is no thread left to look up " + quote(address.host));
    }
    if (answer.wait_until(deadline) != std::future_status::ready) {
      return fail(ErrorCode::DeadlineExceeded, "nobody said in time which computer " + quote(address.host) +
                                                   " is; give its address instead");
    }
    resolved = answer.get();
  }
  if (resolved.status == 0) return std::move(resolved.addresses);
  return fail(ErrorCode::NotFound,
              "there is no computer " + quote(address.host) + ": " + ::gai_strerror(resolved.status));
}

/// 0, or why the connection failed; ETIMEDOUT at the deadline.
int connect_until(int socket, const SocketAddress& address, TimePoint deadline) {
  if (::connect(socket, address.get(), address.size) == 0) return 0;
  if (errno != EINPROGRESS) return errno;
  for (;;) {
    const Duration left = deadline - RealClock::instance().now();
    if (left <= Duration(0)) return ETIMEDOUT;
    pollfd entry{socket, POLLOUT, 0};
    const auto left_ms = std::chrono::ceil<std::chrono::milliseconds>(left).count();
    const int ready = ::poll(&entry, 1, static_cast<int>(std::min<std::int64_t>(left_ms, 3'600'000)));
    if (ready < 0 && errno != EINTR) return errno;
    if (ready <= 0) continue;
    int reason = 0;
    socklen_t size = sizeof reason;
    if (::getsockopt(socket, SOL_SOCKET, SO_ERROR, &reason, &size) != 0) return errno;
    return reason;
  }
}

Error not_connected(const TcpAddress& address, int reason) {
  const std::string where = quote(to_string(address));
  switch (reason) {
    case ETIMEDOUT:
      return no_answer(address);
    case ECONNREFUSED:
      return fail(ErrorCode::Unavailable, "nobody listens at " + where);
    case EHOSTUNREACH:
    case ENETUNREACH:
    case ENETDOWN:
    case EHOSTDOWN:
      return fail(ErrorCode::Unavailable, "no route leads to " + where + "; is the network up?");
    default:
      return system_error("cannot connect to " + where, reason);
  }
}

void set_option(int socket, int level, int option, int value) {
  // Where the system lacks one, the connection works all the same.
  static_cast<void>(::setsockopt(socket, level, option, &value, sizeof value));
}

Result<Descriptor> new_tcp_socket(const SocketAddress& address) {
  Descriptor socket(::socket(address.storage.ss_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!socket.valid()) return system_error("cannot make a TCP socket", errno);
  return socket;
}

using GetName = int (*)(int, sockaddr*, socklen_t*);

TcpAddress address_by(GetName get, int socket) {
  SocketAddress address;
  address.size = sizeof address.storage;
  if (get(socket, reinterpret_cast<sockaddr*>(&address.storage), &address.size) != 0) return {};
  std::array<char, NI_MAXHOST> host{};
  std::array<char, NI_MAXSERV> port{};
  if (::getnameinfo(address.get(), address.size, host.data(), host.size(), port.data(), port.size(),
                    NI_NUMERICHOST | NI_NUMERICSERV) != 0) {
    return {};
  }
  return {host.data(), static_cast<std::uint16_t>(std::strtoul(port.data(), nullptr, 10))};
}

}  // namespace

Result<Descriptor> listen_tcp(const TcpAddress& address) {
  const Resolved resolved = resolve(address, AI_NUMERICHOST | AI_PASSIVE);
  if (resolved.status != 0 || resolved.addresses.empty()) {
    return fail(ErrorCode::InvalidArgument,
                "cannot listen at " + quote(address.host) +
                    ": give the IP address of one of this computer's networks, or 0.0.0.0 or [::] for all");
  }
  auto socket = new_tcp_socket(resolved.addresses.front());
  if (!socket) return socket;
  set_option(socket->get(), SOL_SOCKET, SO_REUSEADDR, 1);
  const SocketAddress& place = resolved.addresses.front();
  if (::bind(socket->get(), place.get(), place.size) != 0 || ::listen(socket->get(), kBacklog) != 0) {
    const std::string what = "cannot listen at " + quote(to_string(address));
    if (errno == EADDRINUSE) {
      return fail(ErrorCode::AlreadyExists, what + ": another program does; choose another port");
    }
    return system_error(what, errno);
  }
  return socket;
}

Result<Descriptor> connect_tcp(const TcpAddress& address, TimePoint deadline) {
  const auto addresses = resolve_until(address, deadline);
  if (!addresses) return addresses.error();
  int reason = EHOSTUNREACH;
  for (std::size_t i = 0; i < addresses->size(); ++i) {
    auto socket = new_tcp_socket((*addresses)[i]);
    if (!socket) return socket;
    tune_tcp(socket->get());
    // One address that swallows everything must not keep us from the next.
    const TimePoint now = RealClock::instance().now();
    const TimePoint until = now + (deadline - now) / static_cast<int>(addresses->size() - i);
    reason = connect_until(socket->get(), (*addresses)[i], until);
    if (reason == 0) return socket;
  }
  return not_connected(address, reason);
}

void tune_tcp(int socket) {
  set_option(socket, IPPROTO_TCP, TCP_NODELAY, 1);
  set_option(socket, SOL_SOCKET, SO_KEEPALIVE, 1);
  set_option(socket, IPPROTO_TCP, TCP_KEEPIDLE, kKeepIdle);
  set_option(socket, IPPROTO_TCP, TCP_KEEPCNT, kKeepCount);
  set_option(socket, IPPROTO_TCP, TCP_KEEPINTVL, kKeepInterval);
  set_option(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, kUserTimeout);
}

std::uint16_t port_of(int socket) {
  return address_by(::getsockname, socket).port;
}

TcpAddress peer_address(int socket) {
  return address_by(::getpeername, socket);
}

}  // namespace segue::control::detail
