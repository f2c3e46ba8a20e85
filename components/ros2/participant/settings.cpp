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

segue::Result<Range> wanted_range(std::string_view wanted) {
  if (wanted == "localhost") return Range::Localhost;
  if (wanted == "subnet") return Range::Subnet;
  if (wanted == "off") return Range::Off;
  return fail(ErrorCode::InvalidArgument,
              "discovery " + quote(wanted) + " is not known: expected localhost, subnet or off");
}

/// From Iron on there is a range, before it a switch, which goes before the range.
bool has_switch() {
  return environment("ROS_LOCALHOST_ONLY") == "1";
}

segue::Result<Range> range_of_environment() {
  const std::string_view range = environment("ROS_AUTOMATIC_DISCOVERY_RANGE");
  if (has_switch() || range == "LOCALHOST") return Range::Localhost;
  if (range.empty() || range == "SUBNET" || range == "SYSTEM_DEFAULT") return Range::Subnet;
  if (range == "OFF") return Range::Off;
  return fail(ErrorCode::InvalidArgument, "$ROS_AUTOMATIC_DISCOVERY_RANGE is " + quote(range) +
                                              ": expected SUBNET, LOCALHOST, OFF or SYSTEM_DEFAULT");
}

/// Parts between semicolons, without those that are empty.
std::vector<std::string> peers_of_environment() {
  std::vector<std::string> peers;
  if (environment("ROS_AUTOMATIC_DISCOVERY_RANGE") == "SYSTEM_DEFAULT") return peers;
  std::string_view rest = environment("ROS_STATIC_PEERS");
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(';'), rest.size());
    if (end > 0) peers.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return peers;
}

}  // namespace

segue::Result<Settings> settings_from(std::int32_t domain, std::string_view discovery,
                                      const std::vector<std::string>& static_peers) {
  Settings settings;
  auto range = discovery.empty() ? range_of_environment() : wanted_range(discovery);
  if (!range) return range.error();
  settings.range = *range;
  if (*range == Range::Off && !static_peers.empty()) {
    return fail(ErrorCode::InvalidArgument,
                "static_peers are named, but discovery is off: choose localhost, or name none");
  }
  const bool is_switched = discovery.empty() && has_switch();
  if (!static_peers.empty()) {
    settings.static_peers = static_peers;
  } else if (*range != Range::Off && !is_switched) {
    settings.static_peers = peers_of_environment();
  }
  settings.domain = static_cast<std::uint32_t>(std::max(domain, 0));
  if (domain >= 0) return settings;
  auto of_environment = domain_of_environment();
  if (!of_environment) return of_environment.error();
  settings.domain = *of_environment;
  return settings;
}

}  // namespace ros2
