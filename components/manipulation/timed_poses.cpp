// SPDX-License-Identifier: Apache-2.0
#include "timed_poses.hpp"

#include <cmath>

namespace manipulation {

void TimedPoses::add(const messages::TimedPose& entry_to_add) {
  if (!std::isfinite(entry_to_add.time) || !is_usable(entry_to_add.pose)) return;
  if (count_ > 0 && entry_to_add.time < entry(count_ - 1).time) clear();
  if (count_ == kCapacity) {
    first_ = (first_ + 1) % kCapacity;
    --count_;
  }
  entries_[(first_ + count_) % kCapacity] = entry_to_add;
  ++count_;
}

std::optional<Pose> TimedPoses::at(double time) const {
  if (count_ == 0 || !(time >= entry(0).time)) return std::nullopt;
  if (time >= entry(count_ - 1).time) return entry(count_ - 1).pose;
  std::size_t later = count_ - 1;
  while (entry(later - 1).time > time)
    --later;
  const messages::TimedPose& a = entry(later - 1);
  const messages::TimedPose& b = entry(later);
  const double share = (time - a.time) / (b.time - a.time);
  Pose pose;
  pose.position = a.pose.position + share * (b.pose.position - a.pose.position);
  pose.orientation = a.pose.orientation.slerp(share, b.pose.orientation);
  return pose;
}

}  // namespace manipulation
