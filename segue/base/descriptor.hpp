// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>

#include <utility>

namespace segue {

/// Owns a file descriptor.
class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_(fd) {}
  ~Descriptor();
  Descriptor(Descriptor&& other) noexcept : fd_(other.release()) {}
  Descriptor& operator=(Descriptor&& other) noexcept;

  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] bool valid() const { return fd_ >= 0; }
  int release() { return std::exchange(fd_, -1); }
  /// Another descriptor (close-on-exec) of the same file; invalid where the system has none left.
  [[nodiscard]] Descriptor duplicate() const;

 private:
  int fd_;
};

/// Blocks until the descriptor can be read from, or has ended, for as long as `within` says; false then.
bool wait_for_input(int descriptor, Deadline within);

}  // namespace segue
