// SPDX-License-Identifier: Apache-2.0
#include "settings.hpp"

#include <segue/base/text.hpp>

#include <algorithm>
#include <charconv>
#include <cstdlib>

namespace ros2 {
namespace {

using segue::ErrorCode;
using segue::fail;
using segue::quote;

std::string_view environment(const char* variable) {
  const char* text = std::getenv(variable);
  return text == nullptr ? std::string_view() : std::string_view(text);
}

segue::Result<std::uint32_t> domain_of_environment() {
  const std::string_view text = environment("ROS_DOMAIN_ID");
  std::uint32_t domain = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), domain);
  if (text.empty() || (error == std::errc() && end == text.data() + text.size())) return domain;
  return fail(ErrorCode::InvalidArgument,
              "$ROS_DOMAIN_ID is " + quote(text) + ", which is not a valid number");
}

/// From Iron on there is a range, before it a switch.
segue::Result<bool> is_localhost_only(std::string_view wanted) {
  if (wanted == "localhost") return true;
  if (wanted == "subnet") return false;
  if (!wanted.empty()) {
    return fail(ErrorCode::InvalidArgument,
                "discovery " + quote(wanted) + " is not known: expected localhost or subnet");
  }
  const std::string_view range = environment("ROS_AUTOMATIC_DISCOVERY_RANGE");
  return range == "LOCALHOST" || (range.empty() && environment("ROS_LOCALHOST_ONLY") == "1");
}

}  // namespace

segue::Result<Settings> settings_from(std::int32_t domain, std::string_view discovery) {
  Settings settings;
  auto localhost = is_localhost_only(discovery);
  if (!localhost) return localhost.error();
  settings.localhost_only = *localhost;
  settings.domain = static_cast<std::uint32_t>(std::max(domain, 0));
  if (domain >= 0) return settings;
  auto of_environment = domain_of_environment();
  if (!of_environment) return of_environment.error();
  settings.domain = *of_environment;
  return settings;
}

}  // namespace ros2
