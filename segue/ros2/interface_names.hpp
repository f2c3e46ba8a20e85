// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/ros2/interface_definition.hpp>

#include <optional>
#include <string_view>

/// The rules of rosidl_adapter and rmw for names. Not for users.
namespace segue::ros2 {

/// Of packages and fields: "nav_msgs".
bool is_package_name(std::string_view name);
/// "LaserScan"
bool is_message_name(std::string_view name);
/// "STATUS_FIX"
bool is_constant_name(std::string_view name);
/// Between the slashes of topics and nodes: "front_camera".
bool is_topic_token(std::string_view name);
/// "float64"; nothing for all other names. "char" is a uint8, as in rosidl.
std::optional<Primitive> primitive_named(std::string_view name);
/// The name of the type of ports with such an item, "/uint8_t"; empty for Nested and wide strings.
std::string_view port_type(Primitive primitive);

}  // namespace segue::ros2
