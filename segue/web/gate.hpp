// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/control/peer.hpp>
#include <segue/web/known_browsers.hpp>

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::web {

using control::Role;

/// What a browser sent, as far as it matters for who may enter. Empty: it has no such header.
struct Entrance {
  std::string target{};  ///< path and query
  std::string host{};
  std::string origin{};
  std::string cookies{};
  bool is_socket = false;  ///< asks for a WebSocket
  std::string address{};   ///< of this computer to which the connection came, without port
  /// What its certificate permits; nothing: it has shown none, and needs a token or a cookie.
  std::optional<Role> certified{};
};

/// Lets browsers in that have shown a certificate, or that bring a token, and knows these by a cookie
/// afterwards. Requests for other names of this computer (DNS rebinding) and of other pages (cross-site
/// requests) are refused. All functions may be called from any thread.
class Gate {
 public:
  struct Admission {
    Role role = Role::Observe;
    /// "Set-Cookie" of a browser that has brought the token: it is spent, and another one is valid.
    std::string new_cookie{};
  };

  struct Place {
    std::string scheme = "http";
    std::vector<std::string> names{};  ///< of this computer, beside the addresses of connections
    std::uint16_t port = 0;
  };

  /// Nobody gets more than `role`, or than the role with which his browser came in.
  Gate(Place place, Role role, KnownBrowsers browsers = KnownBrowsers());

  /// PermissionDenied, with why.
  Result<Admission> admit(const Entrance& entrance);
  /// Opens the page once. A secret.
  [[nodiscard]] std::string token() const;

 private:
  [[nodiscard]] Result<void> check_names(const Entrance& entrance) const;
  [[nodiscard]] std::optional<Role> role_of(std::string_view cookies) const;

  const Place place_;
  const Role role_;
  const std::string cookie_name_;
  mutable std::mutex mutex_;  ///< protects all below
  std::string token_;
  KnownBrowsers browsers_;
};

}  // namespace segue::web
