// SPDX-License-Identifier: Apache-2.0
#include "ros2_system.hpp"

#include <algorithm>
#include <charconv>
#include <string_view>

#include "../output.hpp"

namespace segue::cli {

namespace {

using type::Value;

constexpr int kMostDomain = 232;
constexpr auto kShortLook = std::chrono::milliseconds(500);
/// Of somebody who waits for a completion.
constexpr auto kPatienceForNames = std::chrono::seconds(3);

/// Shells expand what they complete.
bool is_shell_word(std::string_view text) {
  return std::ranges::all_of(text, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '/';
  });
}

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

std::vector<std::string> running_ros2_names(std::string_view list, std::string_view key) {
  Ros2SystemOptions options;
  options.wait = kShortLook;
  const auto seen = look_at_ros2(options, Value::map({{"brief", true}}), kPatienceForNames);
  std::vector<std::string> names;
  for (const Value& one : seen ? list_at(*seen, list) : Value::List()) {
    const std::string& name = one.find(key)->as_string();
    if (is_shell_word(name) && name.find("/_") == std::string::npos) names.push_back(name);
  }
  return names;
}

void print_problems(const Value& seen) {
  for (const Value& problem : seen.find("problems")->as_list())
    print_note(problem.as_string());
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
