// SPDX-License-Identifier: Apache-2.0
#include "timed_poses.hpp"

namespace manipulation {

void TimedPoses::add(const messages::TimedPose& entry) {
  if (is_usable(entry.pose)) entries_.add(entry);
}

std::optional<Pose> TimedPoses::at(double time) const {
  if (entries_.empty() || !(time >= entries_.oldest().time)) return std::nullopt;
  if (time >= entries_.newest().time) return entries_.newest().pose;
  const auto [a, b, share] = entries_.around(time);
  return messages::interpolated(a.pose, b.pose, share);
}

}  // namespace manipulation
