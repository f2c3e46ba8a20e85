// SPDX-License-Identifier: Apache-2.0
#include "tf2_judge.hpp"

#include <console_bridge/console.h>
#include <tf2/buffer_core.h>
#include <tf2/exceptions.h>

#include <tuple>

namespace tf2_judge {

struct Buffer::Core {
  tf2::BufferCore buffer{ros::Duration(1e6)};
};

/// Without tf2's warnings of transforms that come again.
Buffer::Buffer() : core_(std::make_unique<Core>()) {
  console_bridge::noOutputHandler();
}
Buffer::~Buffer() = default;

bool Buffer::insert(const std::string& frame, const std::string& child, const Pose& pose, bool is_static) {
  geometry_msgs::TransformStamped transform;
  transform.header.frame_id = frame;
  transform.header.stamp.fromNSec(static_cast<std::uint64_t>(pose.time));
  transform.child_frame_id = child;
  auto& [x, y, z] = pose.position;
  transform.transform.translation.x = x;
  transform.transform.translation.y = y;
  transform.transform.translation.z = z;
  auto& [qx, qy, qz, qw] = pose.orientation;
  transform.transform.rotation.x = qx;
  transform.transform.rotation.y = qy;
  transform.transform.rotation.z = qz;
  transform.transform.rotation.w = qw;
  return core_->buffer.setTransform(transform, "test", is_static);
}

std::optional<Pose> Buffer::look_up(const std::string& frame, const std::string& child,
                                    std::int64_t time) const {
  try {
    const auto found =
        core_->buffer.lookupTransform(frame, child, ros::Time().fromNSec(static_cast<std::uint64_t>(time)));
    const auto& [translation, rotation] = std::tie(found.transform.translation, found.transform.rotation);
    return Pose{static_cast<std::int64_t>(found.header.stamp.toNSec()),
                {translation.x, translation.y, translation.z},
                {rotation.x, rotation.y, rotation.z, rotation.w}};
  } catch (const tf2::TransformException&) {
    return std::nullopt;
  }
}

}  // namespace tf2_judge
