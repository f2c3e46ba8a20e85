// SPDX-License-Identifier: Apache-2.0
#include "containers.hpp"

#include "../services/requester.hpp"
#include "local_process.hpp"

#include <segue/base/file.hpp>
#include <segue/base/text.hpp>

#include <algorithm>
#include <filesystem>
#include <set>
#include <system_error>
#include <utility>

namespace ros2 {
namespace {

namespace fs = std::filesystem;
using segue::Result;
using segue::ros2::ComponentPlugin;
using segue::type::Value;
using segue::type::ValueMap;

constexpr const char* kListNodes = "/_container/list_nodes";
constexpr const char* kListNodesType = "composition_interfaces/srv/ListNodes";

/// The plugins that an installation has, but for those of packages that are known already.
std::vector<ComponentPlugin> plugins_of(const fs::path& prefix, std::set<std::string>& packages) {
  std::vector<ComponentPlugin> all;
  std::error_code problem;
  const fs::path index = prefix / "share/ament_index/resource_index/rclcpp_components";
  for (fs::directory_iterator entry(index, problem), end; !problem && entry != end;
       entry.increment(problem)) {
    const std::string package = entry->path().filename().string();
    const auto text = segue::read_file(entry->path());
    if (!text || !packages.insert(package).second) continue;
    auto plugins = segue::ros2::parse_component_index(package, *text, prefix.string());
    std::ranges::move(plugins, std::back_inserter(all));
  }
  return all;
}

Value plugin_list(const std::vector<ComponentPlugin>& plugins) {
  Value::List list;
  for (const ComponentPlugin& plugin : plugins)
    list.push_back(Value::map({{"package", plugin.package}, {"name", plugin.name}}));
  return Value(std::move(list));
}

/// Adds what is known of the plugins of all.
void add_plugins(Value::List& components, const std::vector<ComponentPlugin>& loaded) {
  std::vector<std::string> names;
  for (const Value& component : components)
    names.push_back(component.find("name")->as_string());
  const auto found = segue::ros2::find_plugins(names, loaded);
  for (std::size_t i = 0; i < components.size(); ++i) {
    components[i].as_map().set("evidence", segue::ros2::to_string(found[i].evidence));
    components[i].as_map().set("plugins", plugin_list(found[i].plugins));
  }
}

/// The entry `container` of a component.
Value container_of(const Value& component, const Value& name, const Value::List& all) {
  Value::List unknown;
  for (const Value& other : all) {
    if (other.find("evidence")->as_string().empty()) unknown.push_back(*other.find("name"));
  }
  return Value::map({{"name", name},
                     {"id", *component.find("id")},
                     {"evidence", *component.find("evidence")},
                     {"plugins", *component.find("plugins")},
                     {"components", std::int64_t{static_cast<std::int64_t>(all.size())}},
                     {"unknown", Value(std::move(unknown))}});
}

}  // namespace

bool is_container(const Value& node) {
  const std::string service = node.find("name")->as_string() + kListNodes;
  return std::ranges::any_of(node.find("services")->as_list(), [&](const Value& one) {
    return one.find("name")->as_string() == service && one.find("type")->as_string() == kListNodesType;
  });
}

Result<Value::List> ask_components(const Interview& interview, const std::string& container) {
  segue::ros2::InterfaceLibrary library;
  const auto requester =
      Requester::make(interview.participant, library, container + kListNodes, kListNodesType);
  if (!requester) return requester.error();
  (*requester)->allow(true);
  const std::stop_callback ended(interview.stop, [&] { (*requester)->allow(false); });
  const auto answer = (*requester)->call(Value(), segue::Deadline(interview.patience));
  if (!answer) return answer.error();
  const auto& names = answer->find("full_node_names")->as_list();
  const auto& ids = answer->find("unique_ids")->as_list();
  Value::List components;
  for (std::size_t i = 0; i < std::min(names.size(), ids.size()); ++i)
    components.push_back(Value::map({{"id", ids[i]}, {"name", names[i]}}));
  return components;
}

std::vector<ComponentPlugin> loaded_plugins(pid_t process) {
  const auto files = mapped_files(process);
  std::vector<ComponentPlugin> loaded;
  std::set<std::string> packages;
  const std::string prefixes = variable_of(process, "AMENT_PREFIX_PATH");
  for (const std::string_view prefix : segue::split(prefixes, ':')) {
    if (prefix.empty()) continue;
    for (ComponentPlugin& plugin : plugins_of(prefix, packages)) {
      std::error_code problem;
      if (files.contains(fs::weakly_canonical(plugin.library, problem).string()))
        loaded.push_back(std::move(plugin));
    }
  }
  return loaded;
}

void add_components(Value::List components, Value& container, Value::List& nodes) {
  const Value* process = container.find("process");
  add_plugins(components, process == nullptr
                              ? std::vector<ComponentPlugin>()
                              : loaded_plugins(static_cast<pid_t>(process->find("pid")->as_int())));
  const Value name = *container.find("name");
  for (Value& node : nodes) {
    const auto own = std::ranges::find_if(
        components, [&](const Value& component) { return *component.find("name") == *node.find("name"); });
    if (own != components.end()) node.as_map().set("container", container_of(*own, name, components));
  }
  container.as_map().set("components", Value(std::move(components)));
}

}  // namespace ros2
