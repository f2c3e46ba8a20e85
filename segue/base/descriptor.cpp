// SPDX-License-Identifier: Apache-2.0
#include <segue/base/descriptor.hpp>

#include <fcntl.h>
#include <unistd.h>

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

}  // namespace segue
