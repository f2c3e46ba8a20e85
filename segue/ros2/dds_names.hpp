// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace segue::ros2 {

/// The name of an interface's type on DDS ("Topic and Service name mapping to DDS", design.ros2.org):
/// "geometry_msgs::msg::dds_::Point_" for "geometry_msgs/msg/Point".
std::string dds_type_name(std::string_view interface_name);

}  // namespace segue::ros2
