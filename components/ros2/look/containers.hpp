// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "node_interview.hpp"

#include <segue/base/result.hpp>
#include <segue/ros2/component_plugins.hpp>
#include <segue/type/value.hpp>

#include <sys/types.h>

#include <string>
#include <vector>

namespace ros2 {

/// Whether a node, one of segue::ros2::describe_nodes(), is a container of rclcpp_components.
bool is_container(const segue::type::Value& node);

/// Asks a container for its components: [{id, name}]. Fails as Requester::call(). Blocks; any thread.
segue::Result<segue::type::Value::List> ask_components(const Interview& interview,
                                                       const std::string& container);

/// The plugins whose libraries a process of this computer has loaded, in the installations that it was
/// started with ($AMENT_PREFIX_PATH); none where it is another user's.
std::vector<segue::ros2::ComponentPlugin> loaded_plugins(pid_t process);

/// Adds `components` to a container: [{id, name, evidence, plugins: [{package, name}]}], as find_plugins()
/// finds them; and to those of `nodes` that are its components `container`: {name, id, evidence, plugins,
/// components: how many it has, unknown: [NAME of those whose plugins are not known]}.
void add_components(segue::type::Value::List components, segue::type::Value& container,
                    segue::type::Value::List& nodes);

}  // namespace ros2
