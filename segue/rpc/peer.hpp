// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <string>
#include <string_view>

namespace segue::control {

/// The rights of a client; each role includes those before it.
enum class Role {
  Observe,    ///< look: states, samples of ports, events, the journal
  Operate,    ///< also request controllers, set properties, call operations
  Administer  ///< also start and end processes, which run component libraries as the server's user
};

/// "observe", "operate", "administer"; they stand in certificates.
std::string_view to_string(Role role);
/// InvalidArgument names the roles there are.
Result<Role> role_from(std::string_view text);

/// The client at the other end of a connection, as far as the server knows for certain.
struct Peer {
  std::string name;  ///< of its certificate; of its user on this computer. Empty where it is not known yet
  Role role = Role::Observe;
  std::string from;    ///< "10.0.0.3:52114"; empty for a client on this computer
  bool local = false;  ///< connected through the Unix socket
};

/// The person to whom the server gives something that nobody else may use: the name in the certificate; empty
/// for all clients on this computer, whom the socket's permissions admit.
std::string identity_of(const Peer& peer);

/// "'ann' (operate) at 10.0.0.3:52114", for messages.
std::string to_string(const Peer& peer);

}  // namespace segue::control
