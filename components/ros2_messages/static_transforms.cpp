// SPDX-License-Identifier: Apache-2.0
//
// Transforms that do not change: in ROS 2 each is published once, for those that come later, too.
#include "quantities.hpp"
#include "transform_tree.hpp"

#include <segue/base/text.hpp>
#include <segue/task/component.hpp>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace ros2_messages {

/// The pose of a frame in another one, as URDF has it.
struct StaticTransform {
  std::string frame;
  std::string child;
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();  ///< m
  Eigen::Vector3d rpy = Eigen::Vector3d::Zero();  ///< rad: about x, then y, then z of `frame`
};
SEGUE_TYPE(StaticTransform, frame, child, xyz, rpy)

namespace {

geometry_msgs::TransformStamped as_message(const StaticTransform& from, double time) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  geometry_msgs::TransformStamped to;
  to.header.stamp = stamp(time);
  to.header.frame_id = from.frame;
  to.child_frame_id = from.child;
  to.transform.translation = vector(from.xyz);
  to.transform.rotation =
      rotation(AngleAxisd(from.rpy.z(), Vector3d::UnitZ()) * AngleAxisd(from.rpy.y(), Vector3d::UnitY()) *
               AngleAxisd(from.rpy.x(), Vector3d::UnitX()));
  return to;
}

segue::Result<void> check(const std::vector<StaticTransform>& transforms) {
  std::set<std::string> children;
  for (const StaticTransform& transform : transforms) {
    const auto refused = [&](const char* why) {
      return segue::fail(segue::ErrorCode::InvalidArgument, "transform of " + segue::quote(transform.child) +
                                                                " in " + segue::quote(transform.frame) +
                                                                ": " + why);
    };
    if (transform.frame.empty() || transform.child.empty()) return refused("both frames need a name");
    if (transform.frame == transform.child) return refused("these must be two frames");
    if (!transform.xyz.allFinite() || !transform.rpy.allFinite())
      return refused("its numbers must be finite");
    if (!children.insert(transform.child).second) return refused("a frame can be in one other frame only");
  }
  return {};
}

}  // namespace
}  // namespace ros2_messages

namespace to_ros2 {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Tells them once, at its start, with the time of day, as ROS 2's static_transform_publisher does.
class StaticTransforms final : public Component {
 public:
  StaticTransforms()
      : Component({.doc = "Transforms that do not change, as tf2_msgs/msg/TFMessage, for /tf_static"}) {}

 protected:
  segue::Result<void> on_configure() override { return ros2_messages::check(*transforms_); }
  segue::Result<void> on_start() override {
    const double time =
        std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
    tf2_msgs::TFMessage message;
    for (const ros2_messages::StaticTransform& transform : *transforms_)
      message.transforms.push_back(ros2_messages::as_message(transform, time));
    out_.write(message);
    return {};
  }

 private:
  Property<std::vector<ros2_messages::StaticTransform>> transforms_{
      *this,
      "transforms",
      {},
      {.doc = "the pose of each frame `child` in `frame`: xyz in m, rpy (roll, pitch, yaw) in rad"}};
  OutputPort<tf2_msgs::TFMessage> out_{*this, "out"};
};

}  // namespace to_ros2

namespace from_ros2 {

using namespace segue::task;  // NOLINT(google-build-using-namespace)
using ros2_messages::TransformTree;

/// All that have come, in one message: so one who is connected later gets those of all publishers.
class StaticTransforms final : public Component {
 public:
  StaticTransforms()
      : Component({.doc = "Collects the transforms of /tf_static in one tf2_msgs/msg/TFMessage",
                   .trigger_on = {"in"}}) {}

 protected:
  segue::Result<void> on_configure() override {
    tf2_msgs::TFMessage largest;
    largest.transforms.resize(*most_);
    for (geometry_msgs::TransformStamped& transform : largest.transforms)
      transform.header.frame_id = transform.child_frame_id = std::string(TransformTree::kLongestName, ' ');
    known_ = largest.transforms;
    count_ = 0;
    spare_.reserve(kSlots * known_.size());
    out_.prime(largest);
    return {};
  }
  void on_update() override {
    if (!take_all())
      error(left_out_, "a transform was left out: 'most' are known already, or its names are too long");
  }
  void on_error() override { take_all(); }
  void on_cleanup() override {
    known_.clear();
    spare_.clear();
  }

 private:
  /// Whether all could be kept.
  bool take_all() {
    bool all = true;
    bool any = false;
    while (const auto message = in_.take()) {
      any = true;
      for (const geometry_msgs::TransformStamped& transform : message->transforms)
        all = keep(transform) && all;
    }
    if (any) tell();
    return all;
  }

  bool keep(const geometry_msgs::TransformStamped& transform) {
    constexpr std::size_t kLongest = TransformTree::kLongestName;
    if (transform.child_frame_id.size() > kLongest || transform.header.frame_id.size() > kLongest)
      return false;
    const auto end = known_.begin() + static_cast<std::ptrdiff_t>(count_);
    const auto place = std::find_if(known_.begin(), end, [&](const geometry_msgs::TransformStamped& known) {
      return known.child_frame_id == transform.child_frame_id;
    });
    if (place == known_.end()) return false;
    if (place == end) ++count_;
    *place = transform;
    return true;
  }

  void tell() {
    auto to = out_.loan();
    if (!to) return;  // readers hold all of them
    resize(to->transforms);
    std::copy_n(known_.begin(), count_, to->transforms.begin());
    to.publish();
  }

  /// To the number of those that are known. Elements, which have the room for names, are put aside and taken
  /// again, so that nothing is allocated.
  void resize(std::vector<geometry_msgs::TransformStamped>& list) {
    for (; list.size() > count_; list.pop_back())
      if (spare_.size() < spare_.capacity()) spare_.push_back(std::move(list.back()));
    for (; list.size() < count_ && !spare_.empty(); spare_.pop_back())
      list.push_back(std::move(spare_.back()));
    list.resize(count_);
  }

  static constexpr std::size_t kSlots = 16;  ///< of the output, that have readers

  Property<std::uint32_t> most_{*this, "most", 64, {.doc = "transforms that there are at most"}};
  InputPort<tf2_msgs::TFMessage> in_{*this, "in"};
  OutputPort<tf2_msgs::TFMessage> out_{*this, "out"};
  ErrorState left_out_{*this, "left_out"};
  std::vector<geometry_msgs::TransformStamped> known_;  ///< the first `count_`
  std::size_t count_ = 0;
  std::vector<geometry_msgs::TransformStamped> spare_;
};

}  // namespace from_ros2

SEGUE_COMPONENT(to_ros2::StaticTransforms)
SEGUE_COMPONENT(from_ros2::StaticTransforms)
