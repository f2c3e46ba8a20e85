// SPDX-License-Identifier: Apache-2.0
#include "studio_ros2.hpp"

#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "../ros2/ros2_look.hpp"
#include "../ros2/ros2_robot.hpp"

namespace segue::cli {

namespace {

using type::Value;

/// Less than the longest answer of the studio, to which the nodes' texts come.
constexpr std::size_t kMostToldToPages = std::size_t{5} << 20;

}  // namespace

bool is_ros2_used(const std::filesystem::path& installations) {
  for (const char* name : {"ROS_DISTRO", "AMENT_PREFIX_PATH", "ROS_DOMAIN_ID"}) {
    const char* value = std::getenv(name);
    if (value != nullptr && *value != '\0') return true;
  }
  std::error_code unreadable;
  const std::filesystem::directory_iterator first(installations, unreadable);
  return first != std::filesystem::directory_iterator();
}

void prepare_for_pages(Value& seen) {
  for (Value& node : seen.as_map().find("nodes")->as_list()) {
    node.as_map().set("text", ros2_tasks({node}));
    Value* process = node.as_map().find("process");
    if (process == nullptr) continue;
    const auto& words = process->find("command")->as_list();
    const std::string program =
        words.empty() ? "" : std::filesystem::path(words.front().as_string()).filename().string();
    process->as_map().erase("command");
    process->as_map().set("program", program);
  }
}

Result<Value> look_for_pages(const web::Ros2Place& place, const Wait& wait) {
  Ros2SystemOptions options;
  if (place.domain >= 0) options.domain = static_cast<int>(place.domain);
  options.discovery = place.discovery;
  options.most_output = kMostToldToPages;
  auto seen = look_at_ros2(options, Value::map({{"all", true}}), wait);
  if (seen) prepare_for_pages(*seen);
  return seen;
}

}  // namespace segue::cli
