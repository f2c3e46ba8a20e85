// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <string>
#include <string_view>

/// The names by which ROS 2's things go on DDS ("Topic and Service name mapping to DDS", design.ros2.org).
namespace segue::ros2 {

/// The name of an interface's type: "geometry_msgs::msg::dds_::Point_" for "geometry_msgs/msg/Point".
std::string dds_type_name(std::string_view interface_name);
/// The inverse of dds_type_name(); a name that is not one of ROS 2's as it is.
std::string interface_of_dds_type(std::string_view dds_type);

/// "rt/a/chatter" for the topic "/a/chatter" or "a/chatter". InvalidArgument where it is not a name of
/// letters, digits and '_' with '/' between its parts, of which none begins with a digit.
Result<std::string> dds_topic_name(std::string_view topic);
/// The topics of a service's requests and responses: "rq/a/addRequest" and "rr/a/addReply" for "/a/add".
/// InvalidArgument as for topics.
Result<std::string> dds_request_name(std::string_view service);
Result<std::string> dds_response_name(std::string_view service);
/// The inverse of dds_topic_name(); a name that is not one of ROS 2's as it is.
std::string topic_of_dds_name(std::string_view dds_topic);

}  // namespace segue::ros2
