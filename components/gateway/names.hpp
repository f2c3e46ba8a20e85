// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <string>
#include <string_view>

/// The names of Segue's topics and types in DDS, which are those of ROS 2.
namespace gateway {

/// "rt/scan" for "scan" and "/scan". InvalidArgument where the name is empty or has other characters than
/// letters, digits, '_' and single '/'.
segue::Result<std::string> dds_topic_name(std::string_view topic);

/// "base::samples::msg::dds_::Pose_" for "/base/samples/Pose", "sensor_msgs::msg::dds_::Imu_" for
/// "/sensor_msgs/msg/Imu" and "/sensor_msgs/Imu", and "std_msgs::msg::dds_::Empty_" for no type. Types that
/// have no namespace are in "segue". Names with other characters than letters, digits and '_' (of containers
/// and arrays) get '_' in their place and the hash of the whole name at the end, so that different names stay
/// different: "/std/vector</double>" is "segue::msg::dds_::std_vector_double_8770253b_".
std::string dds_type_name(std::string_view type);

}  // namespace gateway
