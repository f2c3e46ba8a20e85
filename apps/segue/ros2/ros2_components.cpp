// SPDX-License-Identifier: Apache-2.0
#include "ros2_components.hpp"

#include <segue/base/printable.hpp>
#include <segue/base/text.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <string_view>

namespace segue::cli {

namespace {

using type::Value;
using type::ValueMap;

constexpr const char* kUsualProgram = "rclcpp_components/component_container_isolated";

std::string shown(const Value& map, std::string_view key) {
  return printable(map.find(key)->as_string());
}

const Value::List& entries(const Value& map, std::string_view key) {
  return map.find(key)->as_list();
}

/// "rclcpp_components/component_container"
std::string program_of(const Value& process) {
  return process.find("package")->as_string() + "/" + process.find("executable")->as_string();
}

bool is_known(const Value& component) {
  return !component.find("evidence")->as_string().empty();
}

/// Whether its program is known and has no nodes but the container and so many components.
bool has_own_program(const Value& node, std::size_t components) {
  const Value* process = node.find("process");
  return process != nullptr && process->find("package") != nullptr &&
         process->find("nodes")->as_int() == static_cast<std::int64_t>(components) + 1;
}

std::string package_and_name(const Value& plugin) {
  return shown(plugin, "name") + " of package " + shown(plugin, "package");
}

std::vector<std::string> shown_all(const Value::List& list) {
  std::vector<std::string> all;
  for (const Value& one : list)
    all.push_back(printable(one.as_string()));
  return all;
}

/// Why the robot cannot start the container.
std::string why_not(const Value& node) {
  const auto unknown = shown_all(entries(*node.find("container"), "unknown"));
  if (!unknown.empty()) return "which plugins it loads for " + listed(unknown) + " is not known";
  const Value* process = node.find("process");
  if (process == nullptr) return "its program is not known";
  return process->find("package") == nullptr ? "its program is not in an installation of packages"
                                             : "its program has other nodes, too";
}

}  // namespace

bool can_load(const Value& node) {
  const Value* container = node.find("container");
  return container != nullptr && entries(*container, "unknown").empty() &&
         has_own_program(node, static_cast<std::size_t>(container->find("components")->as_int()));
}

Value loading_process(const Value& node) {
  const Value& container = *node.find("container");
  const Value& plugin = entries(container, "plugins").front();
  ValueMap map;
  map.set("package", *plugin.find("package"));
  map.set("component", *plugin.find("name"));
  map.set("container", *container.find("name"));
  if (const std::string program = program_of(*node.find("process")); program != kUsualProgram)
    map.set("container_program", program);
  return Value(std::move(map));
}

bool starts_with_components(const Value& container) {
  if (container.find("components") == nullptr) return false;
  const auto& components = entries(container, "components");
  return !components.empty() && std::ranges::all_of(components, is_known) &&
         has_own_program(container, components.size());
}

std::string plugin_text(const Value& component) {
  const std::string evidence = shown(component, "evidence");
  const auto& plugins = entries(component, "plugins");
  if (evidence.empty()) {
    if (plugins.empty()) return "its plugin is not known";
    std::vector<std::string> names;
    for (const Value& plugin : plugins)
      names.push_back(package_and_name(plugin));
    return "its plugin is not known; loaded are " + listed(names);
  }
  return package_and_name(plugins.front()) + (evidence == "name"        ? " (by its name)"
                                              : evidence == "remaining" ? " (the remaining one)"
                                                                        : "");
}

std::vector<std::string> notes_on_component(const Value& node) {
  const Value* container = node.find("container");
  if (container == nullptr) return {};
  const std::string name = shown(*container, "name");
  if (!can_load(node))
    return {fmt::format("component of container {}, which the robot cannot start: {}", name, why_not(node)),
            plugin_text(*container)};
  const Value& process = *node.find("process");
  std::vector<std::string> notes = {
      fmt::format("component of container {} of installation {}", name, shown(process, "installation")),
      "not known are remappings with which it was loaded: add them"};
  if (is_known(*container) && shown(*container, "evidence") != "only_one")
    notes.push_back("its plugin is known by its name or by elimination: check it");
  if (const auto arguments = shown_all(entries(process, "arguments")); !arguments.empty())
    notes.push_back("the container was started with " + listed(arguments) + ", which Segue does not give it");
  return notes;
}

}  // namespace segue::cli
