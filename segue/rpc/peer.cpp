// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/rpc/peer.hpp>

#include <array>

namespace segue::control {

namespace {

/// In the order of Role.
constexpr std::array<std::string_view, 3> kRoles = {"observe", "operate", "administer"};

}  // namespace

std::string_view to_string(Role role) {
  return kRoles.at(static_cast<std::size_t>(role));
}

Result<Role> role_from(std::string_view text) {
  for (std::size_t i = 0; i < kRoles.size(); ++i) {
    if (kRoles.at(i) == text) return static_cast<Role>(i);
  }
  return fail(ErrorCode::InvalidArgument,
              quote(text) + " is not a valid role; there are observe, operate and administer");
}

std::string identity_of(const Peer& peer) {
  return peer.local ? std::string() : peer.name;
}

std::string to_string(const Peer& peer) {
  std::string text = peer.name.empty() ? std::string("a client without a name")
                                       : quote(peer.name) + " (" + std::string(to_string(peer.role)) + ")";
  if (!peer.from.empty()) text += " at " + peer.from;
  return text;
}

}  // namespace segue::control
