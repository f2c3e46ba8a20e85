// SPDX-License-Identifier: Apache-2.0
#include "ros2_system.hpp"

#include <charconv>

namespace segue::cli {

namespace {

using type::Value;

constexpr int kMostDomain = 232;

Result<void> parse_domain(const std::string& text, std::optional<int>& domain) {
  int number = -1;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (problem != std::errc() || end != text.data() + text.size() || number < 0 || number > kMostDomain)
    return fail(ErrorCode::InvalidArgument, text + " is not a valid domain: expected 0 to 232");
  domain = number;
  return {};
}

}  // namespace

void add_ros2_system_options(Verb& verb, Ros2SystemOptions& options, bool asks) {
  verb.option(
      "--domain N", [&options](const std::string& text) { return parse_domain(text, options.domain); },
      "domain of ROS 2, 0 to 232 (default: $ROS_DOMAIN_ID, or 0)");
  verb.option(
          "--discovery RANGE", options.discovery,
          "localhost or subnet (default: as $ROS_AUTOMATIC_DISCOVERY_RANGE or $ROS_LOCALHOST_ONLY say, else "
          "subnet)")
      .one_of({"localhost", "subnet"});
  verb.option("--wait DURATION", options.wait, "how long nodes are listened for (default: 3s)")
      .between(std::chrono::milliseconds(1), kLongestWait);
  if (!asks) return;
  verb.option("--timeout DURATION", options.patience, "how long a node has for its answers (default: 5s)")
      .between(std::chrono::milliseconds(1), kLongestWait);
}

std::string joined_names(const Value& list) {
  std::string text;
  for (const Value& name : list.as_list()) {
    const std::string& one = name.as_string();
    text += (text.empty() ? "" : ", ") + (one.empty() ? "(not of a node)" : one);
  }
  return text;
}

}  // namespace segue::cli
