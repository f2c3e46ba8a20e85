// SPDX-License-Identifier: Apache-2.0
#include <segue/web/gate.hpp>

#include <segue/base/secret.hpp>
#include <segue/base/text.hpp>

#include <algorithm>
#include <utility>

namespace segue::web {

namespace {

constexpr std::string_view kTokenQuery = "/?token=";

/// The next part of "a=1; b=2", which is cut off.
std::string_view next_cookie(std::string_view& cookies) {
  const auto end = cookies.find(';');
  std::string_view one = cookies.substr(0, end);
  cookies = end == std::string_view::npos ? std::string_view() : cookies.substr(end + 1);
  while (one.starts_with(' '))
    one.remove_prefix(1);
  return one;
}

}  // namespace

Gate::Gate(Place place, Role role, KnownBrowsers browsers)
    : place_(std::move(place)),
      role_(role),
      cookie_name_("segue_studio_" + std::to_string(place_.port)),
      token_(random_secret()),
      browsers_(std::move(browsers)) {}

std::string Gate::token() const {
  const std::lock_guard lock(mutex_);
  return token_;
}

Result<void> Gate::check_names(const Entrance& entrance) const {
  const std::string port = ":" + std::to_string(place_.port);
  const auto is_meant = [&](const std::string& name) { return entrance.host == name + port; };
  const bool by_address = !entrance.address.empty() && is_meant(entrance.address);
  if (!by_address && std::ranges::none_of(place_.names, is_meant))
    return fail(ErrorCode::PermissionDenied, "the request is for another host: " + quote(entrance.host));
  const bool needs_origin = entrance.is_socket || !entrance.origin.empty();
  if (needs_origin && entrance.origin != place_.scheme + "://" + entrance.host)
    return fail(ErrorCode::PermissionDenied, "the request is of another page: " + quote(entrance.origin));
  return {};
}

std::optional<Role> Gate::role_of(std::string_view cookies) const {
  const std::string prefix = cookie_name_ + "=";
  std::optional<Role> role;
  while (!cookies.empty() && !role) {
    const std::string_view one = next_cookie(cookies);
    if (one.starts_with(prefix)) role = browsers_.role_of(one.substr(prefix.size()));
  }
  return role;
}

Result<Gate::Admission> Gate::admit(const Entrance& entrance) {
  if (auto named = check_names(entrance); !named) return named.error();
  if (entrance.certified) return Admission{std::min(role_, *entrance.certified), {}};
  const std::lock_guard lock(mutex_);
  const std::string_view target = entrance.target;
  const bool brings_token =
      target.starts_with(kTokenQuery) && equal_secrets(target.substr(kTokenQuery.size()), token_);
  if (!brings_token || entrance.is_socket) {
    if (const auto known = role_of(entrance.cookies)) return Admission{std::min(role_, *known), {}};
    return fail(ErrorCode::PermissionDenied, target.starts_with(kTokenQuery)
                                                 ? "the token is not valid (any more)"
                                                 : "the request has no token and no valid cookie");
  }
  const std::string secret = browsers_.add(role_);
  token_ = random_secret();
  return Admission{role_, cookie_name_ + "=" + secret + "; Path=/; HttpOnly; SameSite=Strict"};
}

}  // namespace segue::web
