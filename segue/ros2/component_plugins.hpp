// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

/// Components of ROS 2: nodes that a container loads from plugins (rclcpp_components).
namespace segue::ros2 {

/// A plugin that a container can load.
struct ComponentPlugin {
  std::string package;
  std::string name;     ///< "nav2_planner::PlannerServer"
  std::string library;  ///< "/opt/ros/jazzy/lib/libplanner_server_core.so"
  friend bool operator==(const ComponentPlugin&, const ComponentPlugin&) = default;
};

/// Those of a package from its text in the index of an installation
/// (PREFIX/share/ament_index/resource_index/rclcpp_components/PACKAGE), whose lines are "NAME;lib/LIBRARY".
std::vector<ComponentPlugin> parse_component_index(const std::string& package, std::string_view text,
                                                   std::string_view prefix);

/// How it is known from which plugin a component was loaded, since no container tells.
enum class PluginEvidence {
  None,      ///< it is not known
  OnlyOne,   ///< the container has loaded no other
  Name,      ///< the class has the name of the node, and no other one has
  Remaining  ///< it is the only one that is not that of a component by its name
};

/// "" for None, "only_one", "name", "remaining".
std::string_view to_string(PluginEvidence evidence);

/// The plugin of a component.
struct FoundPlugin {
  PluginEvidence evidence = PluginEvidence::None;
  std::vector<ComponentPlugin> plugins{};  ///< one; without evidence, all that it may be
};

/// The plugins of the components of a container, in their order, from those whose libraries it has loaded.
std::vector<FoundPlugin> find_plugins(const std::vector<std::string>& components,
                                      const std::vector<ComponentPlugin>& loaded);

}  // namespace segue::ros2
