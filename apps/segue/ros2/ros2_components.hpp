// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include <string>
#include <vector>

/// Nodes that are components of containers (rclcpp_components), as look_at_ros2() tells them.
namespace segue::cli {

/// Whether the robot can start the container of a component anew, with all of its components: their plugins
/// are known, and its program, which has no other nodes.
bool can_load(const type::Value& node);
/// The property `process` of the task of a node that can be loaded.
type::Value loading_process(const type::Value& node);
/// Whether a container is started with its components, so that it needs no task.
bool starts_with_components(const type::Value& container);

/// The plugin of a component (an entry of `components`, or `container` of a node), for people:
/// "nav2_planner::PlannerServer of package nav2_planner (by its name)".
std::string plugin_text(const type::Value& component);
/// For the reader of a network file: that a node is a component, and what about that is not certain; empty
/// for all others.
std::vector<std::string> notes_on_component(const type::Value& node);

}  // namespace segue::cli
