// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/ros2/interface_definition.hpp>

#include <vector>

namespace segue::ros2 {

/// All messages of an interface, its own structure first, from the sections of its file (one, two or three by
/// its kind). A message without fields gets the one that ROS 2 sends in its place.
std::vector<MessageDefinition> messages_of(const InterfaceName& name,
                                           std::vector<MessageDefinition> sections);

}  // namespace segue::ros2
