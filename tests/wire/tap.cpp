// SPDX-License-Identifier: Apache-2.0
#include "wire/tap.hpp"

#include <fcntl.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace segue::wire {
namespace {

constexpr int kQueuedFrames = 10000;  // by the kernel, until they are read here

[[noreturn]] void refuse(const std::string& what) {
  throw NotPermitted(what + ": " + std::strerror(errno));
}

/// The calling thread is in a network name space while this object lives.
class InSpace {
 public:
  explicit InSpace(const std::string& space)
      : before_(::open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC)) {
    const std::string path = "/run/netns/" + space;
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) refuse("cannot open " + path);
    const bool entered = ::setns(file, CLONE_NEWNET) == 0;
    ::close(file);
    if (!entered) refuse("cannot enter the network name space " + space);
  }
  ~InSpace() {
    if (::setns(before_, CLONE_NEWNET) != 0) std::perror("cannot return to the first network name space");
    ::close(before_);
  }
  InSpace(const InSpace&) = delete;
  InSpace& operator=(const InSpace&) = delete;

 private:
  int before_;
};

}  // namespace

Tap::Tap(const std::string& space, const std::string& interface) {
  const InSpace in_space(space);
  file_ = ::open("/dev/net/tun", O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (file_ < 0) refuse("cannot open /dev/net/tun");
  ifreq request{};
  interface.copy(request.ifr_name, IFNAMSIZ - 1);
  request.ifr_flags = IFF_TAP | IFF_NO_PI;
  if (::ioctl(file_, TUNSETIFF, &request) != 0)
    refuse("cannot make the interface " + interface + " in " + space);
  if (::ioctl(file_, SIOCGIFHWADDR, &request) != 0) refuse("cannot read the address of " + interface);
  std::memcpy(address_.data(), request.ifr_hwaddr.sa_data, address_.size());
  request.ifr_qlen = kQueuedFrames;
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const bool resized = ::ioctl(socket, SIOCSIFTXQLEN, &request) == 0;
  ::close(socket);
  if (!resized) refuse("cannot set the length of the queue of " + interface);
}

Tap::~Tap() {
  ::close(file_);
}

std::span<const std::byte> Tap::read(std::span<std::byte> buffer) const {
  const ssize_t size = ::read(file_, buffer.data(), buffer.size());
  return buffer.first(static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
}

void Tap::write(std::span<const std::byte> frame) const {
  if (::write(file_, frame.data(), frame.size()) < 0 && errno != EIO && errno != EAGAIN) {
    std::perror("cannot write a frame");
  }
}

}  // namespace segue::wire
