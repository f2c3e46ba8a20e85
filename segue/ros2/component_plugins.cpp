// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/component_plugins.hpp>

#include <segue/base/text.hpp>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <utility>

namespace segue::ros2 {
namespace {

/// "plannerserver" for "nav2_planner::PlannerServer" and for "/robot/planner_server".
std::string plain_name(std::string_view name) {
  const auto last = name.find_last_of(":/");
  if (last != std::string_view::npos) name.remove_prefix(last + 1);
  std::string plain;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return plain;
}

std::vector<ComponentPlugin> plugins_named(std::string_view node,
                                           const std::vector<ComponentPlugin>& plugins) {
  std::vector<ComponentPlugin> named;
  std::ranges::copy_if(plugins, std::back_inserter(named), [&](const ComponentPlugin& plugin) {
    return plain_name(plugin.name) == plain_name(node);
  });
  return named;
}

}  // namespace

std::vector<ComponentPlugin> parse_component_index(const std::string& package, std::string_view text,
                                                   std::string_view prefix) {
  std::vector<ComponentPlugin> plugins;
  for (const std::string_view line : split(text, '\n')) {
    const auto parts = split(line, ';');
    if (parts.size() != 2 || parts[0].empty() || parts[1].empty()) continue;
    std::string library(parts[1]);
    if (!library.starts_with('/')) library = std::string(prefix) + "/" + library;
    plugins.push_back({package, std::string(parts[0]), std::move(library)});
  }
  return plugins;
}

std::string_view to_string(PluginEvidence evidence) {
  switch (evidence) {
    case PluginEvidence::None:
      return "";
    case PluginEvidence::OnlyOne:
      return "only_one";
    case PluginEvidence::Name:
      return "name";
    case PluginEvidence::Remaining:
      return "remaining";
  }
  return "";
}

std::vector<FoundPlugin> find_plugins(const std::vector<std::string>& components,
                                      const std::vector<ComponentPlugin>& loaded) {
  if (loaded.size() == 1) return {components.size(), {PluginEvidence::OnlyOne, loaded}};
  std::vector<FoundPlugin> found;
  std::vector<ComponentPlugin> remaining = loaded;
  for (const std::string& component : components) {
    auto named = plugins_named(component, loaded);
    if (named.size() != 1) {
      found.push_back({PluginEvidence::None, loaded});
      continue;
    }
    std::erase(remaining, named.front());
    found.push_back({PluginEvidence::Name, std::move(named)});
  }
  if (remaining.size() != 1) return found;
  for (FoundPlugin& one : found) {
    if (one.evidence == PluginEvidence::None) one = {PluginEvidence::Remaining, remaining};
  }
  return found;
}

}  // namespace segue::ros2
