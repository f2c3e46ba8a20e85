// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>

namespace segue::wire {

/// The system does not permit, or does not have, what a wire needs.
struct NotPermitted : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// An Ethernet interface in a network name space whose frames are read and written here. It ends with this
/// object.
class Tap {
 public:
  using Address = std::array<std::byte, 6>;

  /// Makes the interface. Throws NotPermitted with the reason if that cannot be done.
  Tap(const std::string& space, const std::string& interface);
  ~Tap();
  Tap(const Tap&) = delete;
  Tap& operator=(const Tap&) = delete;

  int descriptor() const { return file_; }
  const Address& address() const { return address_; }

  /// The next frame that the name space sends, in `buffer`; empty if there is none now. Does not wait.
  std::span<const std::byte> read(std::span<std::byte> buffer) const;

  /// Gives a frame to the name space, which loses it where the interface is down, as a real one does.
  void write(std::span<const std::byte> frame) const;

 private:
  int file_ = -1;
  Address address_{};
};

}  // namespace segue::wire
