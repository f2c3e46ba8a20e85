// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/dds_names.hpp>

#include <segue/ros2/interface_names.hpp>

#include <segue/base/text.hpp>

#include <algorithm>

namespace segue::ros2 {
namespace {

constexpr std::string_view kTopicPrefix = "rt/";
constexpr std::string_view kTypeSpace = "dds_::";

Result<std::string> dds_name(std::string_view prefix, std::string_view what, std::string_view name,
                             std::string_view suffix) {
  std::string_view rest = name;
  if (rest.starts_with('/')) rest.remove_prefix(1);
  if (rest.empty() || !std::ranges::all_of(split(rest, '/'), is_topic_token)) {
    return fail(
        ErrorCode::InvalidArgument,
        quote(name) + " is not a valid name of a " + std::string(what) +
            ": expected letters, digits and '_', with '/' between its parts, of which none begins with a "
            "digit");
  }
  return std::string(prefix).append(rest).append(suffix);
}

}  // namespace

std::string dds_type_name(std::string_view interface_name) {
  std::string text;
  const auto parts = split(interface_name, '/');
  for (std::size_t i = 0; i + 1 < parts.size(); ++i)
    text.append(parts[i]).append("::");
  return text.append(kTypeSpace).append(parts.back()).append("_");
}

std::string interface_of_dds_type(std::string_view dds_type) {
  const std::size_t space = dds_type.find(kTypeSpace);
  if (space == std::string_view::npos || !dds_type.ends_with('_')) return std::string(dds_type);
  std::string name;
  std::string_view spaces = dds_type.substr(0, space);
  for (std::size_t end = spaces.find("::"); end != std::string_view::npos; end = spaces.find("::")) {
    name.append(spaces.substr(0, end)).append("/");
    spaces.remove_prefix(end + 2);
  }
  std::string_view last = dds_type.substr(space + kTypeSpace.size());
  last.remove_suffix(1);
  return name.append(last);
}

Result<std::string> dds_topic_name(std::string_view topic) {
  return dds_name(kTopicPrefix, "topic", topic, "");
}

Result<std::string> dds_request_name(std::string_view service) {
  return dds_name("rq/", "service", service, "Request");
}

Result<std::string> dds_response_name(std::string_view service) {
  return dds_name("rr/", "service", service, "Reply");
}

std::string topic_of_dds_name(std::string_view dds_topic) {
  if (!dds_topic.starts_with(kTopicPrefix)) return std::string(dds_topic);
  return std::string(dds_topic.substr(kTopicPrefix.size() - 1));
}

}  // namespace segue::ros2
