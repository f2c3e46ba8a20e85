// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rpc/peer.hpp>

#include <chrono>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace segue::control {

namespace detail {
class Encryption;
}

/// The owner of a certificate. The authority alone writes it: the subject has exactly one common name (the
/// name) and one organisational unit (the role), which every tool for certificates shows, and its use stands
/// in the extended key usage, which TLS itself checks.
struct Identity {
  std::string name;  ///< an identifier, never a path
  Role role = Role::Observe;
  bool host = false;   ///< whether a server may show it
  std::string serial;  ///< hexadecimal digits
  std::chrono::system_clock::time_point valid_from;
  std::chrono::system_clock::time_point valid_until;
  /// The DNS names and IP addresses under which browsers may reach a host; numbers as browsers write them.
  std::vector<std::string> addresses{};
};

/// The credentials with which a program identifies itself to the other side of a connection and checks that
/// side: an own certificate with its key, the certificate of the authority and its list of revoked
/// certificates. Copies share all of it; may be used by any thread.
class Credentials {
 public:
  /// load_credentials() makes them from files. `encryption` is not null.
  Credentials(Identity identity, std::shared_ptr<detail::Encryption> encryption)
      : identity_(std::move(identity)), encryption_(std::move(encryption)) {}

  [[nodiscard]] const Identity& identity() const { return identity_; }
  [[nodiscard]] const std::string& name() const { return identity_.name; }
  /// Re-reads the list of revoked certificates whenever its file has changed.
  [[nodiscard]] detail::Encryption& encryption() const { return *encryption_; }

 private:
  Identity identity_;
  std::shared_ptr<detail::Encryption> encryption_;
};

}  // namespace segue::control
