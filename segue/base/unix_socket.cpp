// SPDX-License-Identifier: Apache-2.0
#include <segue/base/unix_socket.hpp>

#include <segue/base/error.hpp>
#include <segue/base/text.hpp>

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string>

namespace segue {

namespace {

constexpr int kBacklog = 64;
constexpr mode_t kOwnerOnlySocket = 0600;

const sockaddr* raw(const sockaddr_un& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

}  // namespace

Result<sockaddr_un> socket_address(const std::filesystem::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string& text = path.native();
  if (text.size() >= sizeof address.sun_path) {
    return fail(ErrorCode::InvalidArgument,
                "the path of the socket " + quote(text) + " is longer than the " +
                    std::to_string(sizeof address.sun_path - 1) +
                    " bytes that the system allows; give robot or process a shorter name, or set "
                    "XDG_RUNTIME_DIR to a folder with a shorter path");
  }
  std::copy(text.begin(), text.end(), address.sun_path);
  return address;
}

Result<Descriptor> new_socket() {
  Descriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!socket.valid()) return system_error("cannot make a socket", errno);
  return socket;
}

int connect_once(int socket, const sockaddr_un& address) {
  return ::connect(socket, raw(address), sizeof address) == 0 ? 0 : errno;
}

Result<Descriptor> listen_at(const std::filesystem::path& path) {
  const auto address = socket_address(path);
  if (!address) return address.error();
  auto socket = new_socket();
  if (!socket) return socket;
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) {
    return system_error("cannot remove the stale socket " + quote(path.native()), errno);
  }
  if (::bind(socket->get(), raw(*address), sizeof *address) != 0) {
    return system_error("cannot make the socket " + quote(path.native()), errno);
  }
  // Nobody can connect before listen(), so the mode is right before it matters.
  if (::chmod(path.c_str(), kOwnerOnlySocket) != 0 || ::listen(socket->get(), kBacklog) != 0) {
    const int reason = errno;
    ::unlink(path.c_str());
    return system_error("cannot listen on " + quote(path.native()), reason);
  }
  return socket;
}

}  // namespace segue
