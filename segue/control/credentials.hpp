// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/control/peer.hpp>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace segue::control {

namespace detail {
class Encryption;
}

/// What a certificate says of its owner. The authority alone writes it: the subject has exactly one common
/// name (the name) and one organisational unit (the role), which every tool for certificates shows, and what
/// it is for stands in the extended key usage, which TLS itself checks.
struct Identity {
  std::string name;  ///< an identifier, never a path
  Role role = Role::Observe;
  bool host = false;   ///< whether a server may show it
  std::string serial;  ///< hexadecimal digits
  std::chrono::system_clock::time_point valid_from;
  std::chrono::system_clock::time_point valid_until;
  /// Of a host: DNS names and IP addresses under which browsers may reach it; numbers as browsers write them.
  std::vector<std::string> addresses{};
};

/// What a program shows the other side of a connection, and what it believes of it: an own certificate with
/// its key, the certificate of the authority and its list of revoked certificates. Copies share all of it;
/// may be used by any thread.
class Credentials {
 public:
  enum class Use { Person, Host };

  /// From a folder with ca.crt, ca.crl, NAME.crt and NAME.key, as `segue host enrol` makes it. Without a name
  /// it is the only certificate there for that use, of a person also the host's where there is no other.
  /// Fails where a file is missing, others can read the key (PermissionDenied), the certificate has expired
  /// (it says when), is not for that use, does not belong to the key or was issued by another authority.
  static Result<Credentials> load(const std::filesystem::path& folder, Use use, std::string_view name = {});

  [[nodiscard]] const Identity& identity() const { return identity_; }
  [[nodiscard]] const std::string& name() const { return identity_.name; }
  /// Re-reads the list of revoked certificates whenever its file has changed.
  [[nodiscard]] detail::Encryption& encryption() const { return *encryption_; }

 private:
  Credentials(Identity identity, std::shared_ptr<detail::Encryption> encryption)
      : identity_(std::move(identity)), encryption_(std::move(encryption)) {}

  Identity identity_;
  std::shared_ptr<detail::Encryption> encryption_;
};

/// Where this user's credentials are unless told otherwise: `$XDG_CONFIG_HOME/segue/credentials`, else
/// `~/.config/segue/credentials`; `/etc/segue/credentials` for root. InvalidState where no home is known.
Result<std::filesystem::path> credentials_folder();

}  // namespace segue::control
