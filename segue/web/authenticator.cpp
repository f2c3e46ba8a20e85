// SPDX-License-Identifier: Apache-2.0
#include <segue/web/authenticator.hpp>

#include <segue/base/secret.hpp>
#include <segue/base/text.hpp>

#include <algorithm>
#include <utility>

namespace segue::web {

namespace {

constexpr std::string_view kTokenQuery = "/?token=";
constexpr std::string_view kKeyPrefix = "key.";

/// The next part of "a=1; b=2", which is cut off.
std::string_view next_part(std::string_view& parts, char separator) {
  const auto end = parts.find(separator);
  std::string_view one = parts.substr(0, end);
  parts = end == std::string_view::npos ? std::string_view() : parts.substr(end + 1);
  while (one.starts_with(' '))
    one.remove_prefix(1);
  return one;
}

/// The rest behind `prefix`, of each part that begins with it.
std::vector<std::string_view> values_of(std::string_view parts, char separator, std::string_view prefix) {
  std::vector<std::string_view> values;
  while (!parts.empty()) {
    const std::string_view one = next_part(parts, separator);
    if (one.starts_with(prefix)) values.push_back(one.substr(prefix.size()));
  }
  return values;
}

/// Names of computers are the same in small letters and capitals.
std::string in_small_letters(std::string text) {
  std::ranges::transform(text, text.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c; });
  return text;
}

/// As it stands in addresses of pages.
std::string written_name(const std::string& name) {
  return name.find(':') == std::string::npos ? in_small_letters(name) : "[" + in_small_letters(name) + "]";
}

std::uint16_t usual_port(const std::string& scheme) {
  return scheme == "https" ? 443 : 80;
}

}  // namespace

Authenticator::Authenticator(Place place, Role role)
    : place_(std::move(place)),
      role_(role),
      cookie_name_("segue_studio_" + std::to_string(place_.port)),
      token_(random_secret()) {}

std::string Authenticator::token() const {
  const Lock lock(mutex_);
  return token_;
}

/// `host` in small letters. Browsers leave out the port that is usual.
bool Authenticator::is_meant(const std::string& host, const std::string& address) const {
  const bool is_usual = place_.port == usual_port(place_.scheme);
  const std::string port = ":" + std::to_string(place_.port);
  const auto is_same = [&](const std::string& name) {
    return host == name + port || (is_usual && host == name);
  };
  return (!address.empty() && is_same(address)) ||
         std::ranges::any_of(place_.names, [&](const auto& name) { return is_same(written_name(name)); });
}

Result<void> Authenticator::check_names(const Entrance& entrance) const {
  const std::string host = in_small_letters(entrance.host);
  if (!is_meant(host, entrance.address))
    return fail(ErrorCode::PermissionDenied, "the request is for another host: " + quote(entrance.host));
  const bool needs_origin = entrance.is_socket || !entrance.origin.empty();
  if (needs_origin && in_small_letters(entrance.origin) != place_.scheme + "://" + host)
    return fail(ErrorCode::PermissionDenied, "the request is of another page: " + quote(entrance.origin));
  return {};
}

const Authenticator::Browser* Authenticator::browser_with(std::string_view cookies) const {
  const Browser* found = nullptr;
  for (const std::string_view cookie : values_of(cookies, ';', cookie_name_ + "=")) {
    for (const Browser& browser : browsers_) {
      if (equal_secrets(browser.cookie, cookie)) found = &browser;
    }
  }
  return found;
}

Result<Authenticator::Admission> Authenticator::admit_known(const Entrance& entrance) const {
  const Browser* browser = browser_with(entrance.cookies);
  if (browser == nullptr)
    return fail(ErrorCode::PermissionDenied, entrance.target.starts_with(kTokenQuery)
                                                 ? "the token is not valid (any more)"
                                                 : "the request has no token and no valid cookie");
  const auto keys = values_of(entrance.protocols, ',', kKeyPrefix);
  const bool has_key = keys.size() == 1 && equal_secrets(keys.front(), browser->key);
  if (entrance.is_socket && !has_key)
    return fail(ErrorCode::PermissionDenied,
                "the request has a valid cookie, but not the key of its browser");
  return Admission{role_, browser->number};
}

Authenticator::Admission Authenticator::add_browser() {
  std::uint64_t forgotten = 0;
  if (browsers_.size() >= kMostBrowsers) {
    forgotten = browsers_.front().number;
    browsers_.erase(browsers_.begin());
  }
  browsers_.push_back({++last_number_, random_secret(), random_secret()});
  const Browser& browser = browsers_.back();
  const std::string cookie = cookie_name_ + "=" + browser.cookie + "; Path=/; HttpOnly; SameSite=Strict";
  return {role_, browser.number, cookie, browser.key, forgotten};
}

Result<Authenticator::Admission> Authenticator::admit(const Entrance& entrance) {
  if (auto named = check_names(entrance); !named) return named.error();
  if (entrance.certified) return Admission{std::min(role_, *entrance.certified)};
  const Lock lock(mutex_);
  const std::string_view target = entrance.target;
  const bool brings_token =
      target.starts_with(kTokenQuery) && equal_secrets(target.substr(kTokenQuery.size()), token_);
  if (!brings_token || entrance.is_socket) return admit_known(entrance);
  token_ = random_secret();
  return add_browser();
}

}  // namespace segue::web
