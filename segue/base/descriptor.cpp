// SPDX-License-Identifier: Apache-2.0
#include <segue/base/descriptor.hpp>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdint>

namespace segue {

Descriptor::~Descriptor() {
  if (fd_ >= 0) {
    ::close(fd_);
  }
}

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  Descriptor taken(std::move(other));
  std::swap(fd_, taken.fd_);
  return *this;
}

Descriptor Descriptor::duplicate() const {
  return Descriptor(valid() ? ::fcntl(fd_, F_DUPFD_CLOEXEC, 0) : -1);
}

bool wait_for_input(int descriptor, Deadline within) {
  const TimePoint deadline = within;
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - RealClock::instance().now());
    pollfd waited{descriptor, POLLIN, 0};
    const int ready = ::poll(&waited, 1, static_cast<int>(std::max<std::int64_t>(left.count(), 0)));
    if (ready >= 0 || errno != EINTR) return ready > 0;
  }
}

}  // namespace segue
