// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/peer.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::web {

using control::Role;

/// The browsers that came in with a token: each has a secret in its cookie, of which a digest is kept here,
/// and in a file, if there is one, so that a studio that starts again knows them. Not thread safe.
class KnownBrowsers {
 public:
  static constexpr std::size_t kMost = 64;  ///< the one that came first is forgotten

  /// Empty: no file. A file that cannot be read or is of something else counts as empty.
  explicit KnownBrowsers(std::filesystem::path file = {});

  /// What the browser with that secret may do; nothing where it is not known.
  [[nodiscard]] std::optional<Role> role_of(std::string_view secret) const;
  /// A new secret. Where the file cannot be written, the browser is known until the studio ends.
  std::string add(Role role);

 private:
  struct Browser {
    Role role = Role::Observe;
    std::string digest;
  };

  void keep() const;

  const std::filesystem::path file_;
  std::vector<Browser> browsers_;
};

}  // namespace segue::web
