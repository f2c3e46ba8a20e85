// SPDX-License-Identifier: Apache-2.0
#include "transform_tree.hpp"

#include "../messages/poses.hpp"
#include "quantities.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ros2_messages {
namespace {

using Frame = TransformTree::Frame;

/// Names once began with a slash, which still is the same frame.
std::string_view without_slash(std::string_view name) {
  if (name.starts_with('/')) name.remove_prefix(1);
  return name;
}

bool is_name(std::string_view name) {
  return !name.empty() && name.size() <= TransformTree::kLongestName;
}

/// As tf2 has it.
bool is_rotation(const Eigen::Quaterniond& q) {
  constexpr double kTolerance = 0.01;
  return std::abs(q.squaredNorm() - 1) <= kTolerance;  // also false where it is not a number
}

void keep(Frame& frame, const messages::TimedPose& pose) {
  const bool is_known = !frame.poses.empty();
  if (is_known && pose.time == frame.poses.newest().time) return;
  if (is_known && pose.time < frame.poses.newest().time && ++frame.late < TransformTree::kLateOnes) return;
  frame.late = 0;
  frame.poses.add(pose);
}

/// Whether there is one.
bool pose_at(const Frame& frame, double time, messages::Pose& pose) {
  const auto& poses = frame.poses;
  if (frame.is_static || time == poses.newest().time) {
    pose = poses.newest().pose;
    return true;
  }
  if (!(time >= poses.oldest().time && time < poses.newest().time)) return false;
  const auto [before, after, share] = poses.around(time);
  pose = messages::interpolated(before.pose, after.pose, share);
  return true;
}

}  // namespace

TransformTree::TransformTree(std::size_t frames) : frames_(frames) {
  for (Frame& frame : frames_)
    frame.name.reserve(kLongestName);
  child_side_.reserve(frames);
  frame_side_.reserve(frames);
}

std::size_t TransformTree::find(std::string_view name) const {
  for (std::size_t i = 0; i < known_; ++i)
    if (frames_[i].name == name) return i;
  return kNone;
}

std::size_t TransformTree::find_or_add(std::string_view name) {
  const std::size_t found = find(name);
  if (found != kNone || known_ == frames_.size()) return found;
  frames_[known_].name = name;
  return known_++;
}

Problem TransformTree::insert(const geometry_msgs::TransformStamped& transform, bool is_static) {
  const std::string_view parent = without_slash(transform.header.frame_id);
  const std::string_view child = without_slash(transform.child_frame_id);
  if (!is_name(parent) || !is_name(child))
    return "a transform names no frame, or one with a name that is too long";
  if (parent == child) return "a transform has the same frame twice";
  messages::TimedPose pose{is_static ? 0 : seconds(transform.header.stamp),
                           {vector(transform.transform.translation), rotation(transform.transform.rotation)}};
  if (!pose.pose.position.allFinite() || !is_rotation(pose.pose.orientation))
    return "a transform is not finite, or its rotation is not normalized";
  pose.pose.orientation.normalize();
  const std::size_t parent_index = find_or_add(parent);
  const std::size_t index = find_or_add(child);
  if (parent_index == kNone || index == kNone)
    return "there are more frames than the property 'most_frames' allows";
  Frame& frame = frames_[index];
  if (frame.parent != parent_index || frame.is_static || is_static) frame.poses.clear();
  frame.parent = parent_index;
  frame.is_static = is_static;
  keep(frame, pose);
  return nullptr;
}

Located TransformTree::connect(std::string_view frame, std::string_view child) {
  child_side_.clear();
  frame_side_.clear();
  const std::size_t last = find(child);
  const std::size_t first = find(frame);
  if (last == kNone) return {"no transform names frame", child};
  if (first == kNone) return {"no transform names frame", frame};
  for (std::size_t i = last; i != kNone; i = frames_[i].parent) {
    if (child_side_.size() == known_)
      return {"the transforms go round in a circle at frame", frames_[i].name};
    child_side_.push_back(i);
  }
  for (std::size_t i = first; i != kNone; i = frames_[i].parent) {
    const auto common = std::ranges::find(child_side_, i);
    if (common != child_side_.end()) {
      child_side_.erase(common, child_side_.end());
      return {};
    }
    if (frame_side_.size() == known_)
      return {"the transforms go round in a circle at frame", frames_[i].name};
    frame_side_.push_back(i);
  }
  return {"no chain of transforms leads from it to frame", frame};
}

Located TransformTree::locate_at(double time) const {
  Located located;
  located.pose.time = time;
  const auto compose_side = [&](const std::vector<std::size_t>& side) {
    messages::Pose composed;
    for (const std::size_t i : side) {
      messages::Pose pose;
      if (!pose_at(frames_[i], time, pose) && located.problem == nullptr) {
        located.problem = "the times of transforms do not meet at frame";
        located.frame = frames_[i].name;
      }
      located.moves = located.moves || !frames_[i].is_static;
      composed = messages::compose(pose, composed);
    }
    return composed;
  };
  const messages::Pose child = compose_side(child_side_);
  located.pose.pose = messages::compose(messages::inverse(compose_side(frame_side_)), child);
  return located;
}

Located TransformTree::newest(std::string_view frame, std::string_view child) {
  if (Located failed = connect(frame, child); failed.problem != nullptr) return failed;
  double time = std::numeric_limits<double>::infinity();
  std::string_view oldest;
  for (const auto* side : {&child_side_, &frame_side_}) {
    for (const std::size_t i : *side) {
      if (frames_[i].is_static || frames_[i].poses.newest().time >= time) continue;
      time = frames_[i].poses.newest().time;
      oldest = frames_[i].name;
    }
  }
  Located located = locate_at(std::isfinite(time) ? time : 0);
  if (located.problem == nullptr) located.frame = oldest;
  return located;
}

Located TransformTree::at(std::string_view frame, std::string_view child, double time) {
  if (Located failed = connect(frame, child); failed.problem != nullptr) return failed;
  return locate_at(time);
}

}  // namespace ros2_messages
