// SPDX-License-Identifier: Apache-2.0
#include <segue/web/known_browsers.hpp>

#include <segue/base/file.hpp>
#include <segue/base/secret.hpp>
#include <segue/base/sha256.hpp>

#include <sstream>
#include <utility>

namespace segue::web {

namespace {

constexpr std::string_view kHexadecimal = "0123456789abcdef";
constexpr std::size_t kDigits = 64;  // of 256 bits
constexpr std::size_t kLongestFile = 100 * KnownBrowsers::kMost;

}  // namespace

KnownBrowsers::KnownBrowsers(std::filesystem::path file) : file_(std::move(file)) {
  if (file_.empty()) return;
  const auto text = read_file(file_, kLongestFile);
  std::istringstream words(text ? *text : "");
  for (std::string role, digest; words >> role >> digest && browsers_.size() < kMost;) {
    const auto known = control::role_from(role);
    const bool is_digest =
        digest.size() == kDigits && digest.find_first_not_of(kHexadecimal) == std::string::npos;
    if (known && is_digest) browsers_.push_back({*known, digest});
  }
}

std::optional<Role> KnownBrowsers::role_of(std::string_view secret) const {
  const std::string digest = sha256(secret);
  std::optional<Role> role;
  for (const Browser& browser : browsers_) {
    if (equal_secrets(browser.digest, digest)) role = browser.role;
  }
  return role;
}

std::string KnownBrowsers::add(Role role) {
  if (browsers_.size() >= kMost) browsers_.erase(browsers_.begin());
  std::string secret = random_secret();
  browsers_.push_back({role, sha256(secret)});
  keep();
  return secret;
}

void KnownBrowsers::keep() const {
  if (file_.empty()) return;
  std::string text;
  for (const Browser& browser : browsers_)
    text += std::string(to_string(browser.role)) + " " + browser.digest + "\n";
  static_cast<void>(write_private_file(file_, text));
}

}  // namespace segue::web
