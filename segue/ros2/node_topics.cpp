// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/node_topics.hpp>

#include <segue/base/text.hpp>
#include <segue/ros2/dds_names.hpp>

#include <optional>
#include <utility>

namespace segue::ros2 {
namespace {

using type::Value;
using type::ValueMap;

/// "/robot/scan" for "scan" of node "/robot/lidar", "/robot/lidar/scan" for "~/scan".
std::string expanded(std::string_view topic, std::string_view node) {
  if (topic.starts_with('/')) return std::string(topic);
  if (topic.starts_with("~/")) return std::string(node) + std::string(topic.substr(1));
  return std::string(node.substr(0, node.rfind('/') + 1)) + std::string(topic);
}

/// "node:FROM" and "rostopic://FROM"; nothing where it is not for topics of this node.
std::optional<std::string_view> subject_of(std::string_view from, std::string_view node) {
  constexpr std::string_view kTopics = "rostopic://";
  constexpr std::string_view kServices = "rosservice://";
  const std::size_t slashes = from.find("://");
  const std::size_t colon = from.find(':');
  if (colon != std::string_view::npos && colon != slashes) {
    if (from.substr(0, colon) != node.substr(node.rfind('/') + 1)) return {};
    from.remove_prefix(colon + 1);
  }
  if (from.starts_with(kServices)) return {};
  if (from.starts_with(kTopics)) from.remove_prefix(kTopics.size());
  return from;
}

std::string text_in(const Value& map, std::string_view key) {
  const Value* value = map.is_map() ? map.find(key) : nullptr;
  return value != nullptr && value->is_string() ? value->as_string() : std::string();
}

std::vector<std::string> remappings_of(const Value& properties) {
  std::vector<std::string> rules;
  const Value* process = properties.find("process");
  const Value* list = process != nullptr && process->is_map() ? process->find("remappings") : nullptr;
  if (list == nullptr || !list->is_list()) return rules;
  for (const Value& rule : list->as_list()) {
    if (rule.is_string()) rules.push_back(rule.as_string());
  }
  return rules;
}

}  // namespace

Result<std::string> resolve_topic(std::string_view topic, std::string_view node,
                                  const std::vector<std::string>& remappings) {
  std::string full = expanded(topic, node);
  for (const std::string_view rule : remappings) {
    const std::size_t to = rule.find(":=");
    const auto from = subject_of(rule.substr(0, to), node);
    if (to == std::string_view::npos || !from || expanded(*from, node) != full) continue;
    std::string_view target = rule.substr(to + 2);
    if (target.starts_with("rostopic://")) target.remove_prefix(std::string_view("rostopic://").size());
    full = expanded(target, node);
    break;
  }
  if (auto valid = dds_topic_name(full); !valid) return valid.error();
  return full;
}

Result<Value> topic_settings(const std::string& port, const Value& entry, std::string_view path) {
  ValueMap map;
  if (entry.is_map()) {
    map = entry.as_map();
  } else if (entry.is_string()) {
    map.set("type", entry);
  }
  if (text_in(Value(map), "type").empty()) {
    return fail(
        ErrorCode::InvalidArgument,
        std::string(path) +
            ": expected an interface, such as sensor_msgs/msg/LaserScan, or a map with type: and topic:");
  }
  if (map.find("topic") == nullptr) map.set("topic", port);
  return Value(std::move(map));
}

std::vector<NodeTopic> topics_of_task(const Value& properties) {
  std::vector<NodeTopic> all;
  if (!properties.is_map()) return all;
  const std::vector<std::string> rules = remappings_of(properties);
  for (const auto& [key, is_published] : {std::pair{"publishes", true}, {"subscribes", false}}) {
    const Value* ports = properties.find(key);
    if (ports == nullptr || !ports->is_map()) continue;
    for (const auto& [port, entry] : ports->as_map()) {
      const auto settings = topic_settings(port, entry, port);
      if (!settings) continue;
      const auto topic = resolve_topic(text_in(*settings, "topic"), text_in(properties, "name"), rules);
      if (topic) all.push_back({port, is_published, *topic, text_in(*settings, "type")});
    }
  }
  return all;
}

}  // namespace segue::ros2
