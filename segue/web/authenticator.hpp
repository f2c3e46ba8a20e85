// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/rpc/peer.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::web {

using control::Role;

/// The parts of a browser's request that decide whether it may enter. Empty: it has no such header.
struct Entrance {
  std::string target{};  ///< path and query
  std::string host{};
  std::string origin{};
  std::string cookies{};
  std::string protocols{};  ///< that its WebSocket offers, one of them "key.KEY"
  bool is_socket = false;   ///< asks for a WebSocket
  std::string address{};    ///< of this computer to which the connection came, without port
  /// The role of its certificate; nothing: it has shown none, and needs a token, or a cookie and a key.
  std::optional<Role> certified{};
};

/// Lets browsers in that have shown a certificate, or that bring a token, and knows these afterwards, until
/// this ends. Requests for other names of this computer (DNS rebinding) and of other pages (cross-site
/// requests) are refused.
///
/// A browser that brings the token gets a cookie and a key. The cookie opens the page's files. Browsers send
/// it to every server of this computer, whatever its port and whoever runs it, so it opens nothing else: a
/// WebSocket, through which a robot is seen and commanded, needs the key, too. That is in the part of an
/// address that browsers do not send, and then kept by the page, where only pages of this port find it.
///
/// All functions may be called from any thread.
class Authenticator {
 public:
  /// Of the browsers that are known; the one that came first is forgotten, and its connections are to end.
  static constexpr std::size_t kMostBrowsers = 64;
  /// Of the WebSocket; a page that brings a key offers it.
  static constexpr std::string_view kProtocol = "segue.studio";

  struct Admission {
    Role role = Role::Observe;
    std::uint64_t browser = 0;  ///< its number; 0: it has shown a certificate
    /// "Set-Cookie" of a browser that has brought the token: it is spent, and another one is valid.
    std::string new_cookie{};
    std::string new_key{};  ///< the key of such a browser; for the page alone
    /// The number of the browser that was forgotten for this one; 0: none was.
    std::uint64_t forgotten = 0;
  };

  struct Place {
    std::string scheme = "http";
    /// Of this computer, beside the addresses of connections: DNS names and IP addresses, without brackets.
    std::vector<std::string> names{};
    std::uint16_t port = 0;
  };

  /// Nobody gets more than `role`.
  Authenticator(Place place, Role role);

  /// PermissionDenied, with why.
  Result<Admission> admit(const Entrance& entrance);
  /// Opens the page once. A secret.
  [[nodiscard]] std::string token() const;

 private:
  struct Browser {
    std::uint64_t number = 0;
    std::string cookie{};
    std::string key{};
  };

  [[nodiscard]] bool is_meant(const std::string& host, const std::string& address) const;
  [[nodiscard]] Result<void> check_names(const Entrance& entrance) const;
  [[nodiscard]] Result<Admission> admit_known(const Entrance& entrance) const SEGUE_REQUIRES(mutex_);
  [[nodiscard]] const Browser* browser_with(std::string_view cookies) const SEGUE_REQUIRES(mutex_);
  Admission add_browser() SEGUE_REQUIRES(mutex_);

  const Place place_;
  const Role role_;
  const std::string cookie_name_;
  mutable Mutex mutex_;  ///< protects all below
  std::string token_ SEGUE_GUARDED_BY(mutex_);
  std::vector<Browser> browsers_ SEGUE_GUARDED_BY(mutex_);
  std::uint64_t last_number_ SEGUE_GUARDED_BY(mutex_) = 0;
};

}  // namespace segue::web
