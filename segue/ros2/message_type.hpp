// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/ros2/interface_library.hpp>
#include <segue/type/type.hpp>

#include <map>
#include <string>
#include <string_view>

namespace segue::ros2 {

/// The defaults that the message and its parts have in their files, for make_type_info(): by type name, a map
/// of members.
Result<std::map<std::string, type::Value>> message_defaults(InterfaceLibrary& library, std::string_view name);

/// The type by which Segue handles objects of a message, with its parts in `registry`:
/// "/geometry_msgs/Point" for geometry_msgs/msg/Point, with the layout of the C++ struct geometry_msgs::Point
/// that has the same members. Bounds of texts and sequences are not part of the type (message_bounds.hpp).
/// Unsupported where the message has a wstring, which ROS 2's middlewares encode in different ways.
Result<const type::Type*> message_type(InterfaceLibrary& library, std::string_view name,
                                       type::TypeRegistry& registry);

/// "/geometry_msgs/Point" for "geometry_msgs/msg/Point", "/std_srvs/SetBool_Request" for
/// "std_srvs/srv/SetBool_Request".
std::string type_name(std::string_view interface_name);

}  // namespace segue::ros2
