// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/used_interfaces.hpp>

#include <segue/base/text.hpp>
#include <segue/ros2/interface_definition.hpp>

namespace segue::ros2 {
namespace {

using type::Value;

/// The interface that has the type of a topic: a message, or a service where its events are published.
std::string interface_of(const std::string& type) {
  const auto name = parse_interface_name(type);
  return !name || name->kind == "msg" ? type : type.substr(0, type.find('_', type.rfind('/')));
}

}  // namespace

std::map<std::string, TypeHashes> used_interfaces(const Value& node) {
  std::map<std::string, TypeHashes> used;
  for (const char* direction : {"publishers", "subscriptions"}) {
    for (const Value& topic : node.find(direction)->as_list()) {
      const std::string& type = topic.find("type")->as_string();
      const std::string& hash = topic.find("hash")->as_string();
      auto& hashes = used[interface_of(type)];
      if (!hash.empty()) hashes.emplace(type, hash);
    }
  }
  for (const char* role : {"services", "clients", "actions", "action_clients"}) {
    for (const Value& one : node.find(role)->as_list()) {
      auto& hashes = used[one.find("type")->as_string()];
      const Value* told = one.find("hashes");
      if (told == nullptr) continue;
      for (const auto& [part, hash] : told->as_map())
        hashes.emplace(part, hash.as_string());
    }
  }
  return used;
}

std::vector<std::string> parts_to_ask(const std::string& interface, const TypeHashes& hashes) {
  if (hashes.contains(interface)) return {interface};
  // Events are published where the service is introspected.
  if (hashes.contains(interface + "_Event")) return {interface + "_Event"};
  std::vector<std::string> parts;
  for (const char* suffix : {"_SendGoal", "_GetResult", "_FeedbackMessage"}) {
    if (!hashes.contains(interface + suffix)) return {};
    parts.push_back(interface + suffix);
  }
  return parts;
}

}  // namespace segue::ros2
