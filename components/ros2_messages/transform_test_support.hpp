// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "quantities.hpp"

#include <geometry_msgs/msg/transform_stamped.hpp>

#include <string>

/// For tests only.
namespace ros2_messages {

/// The child `x` metres ahead of the frame, at a time in seconds.
inline geometry_msgs::TransformStamped made_transform(const std::string& frame, const std::string& child,
                                                      double time, double x) {
  geometry_msgs::TransformStamped made;
  made.header.stamp = stamp(time);
  made.header.frame_id = frame;
  made.child_frame_id = child;
  made.transform.translation.x = x;
  made.transform.rotation.w = 1;
  return made;
}

}  // namespace ros2_messages
