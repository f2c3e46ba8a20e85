// SPDX-License-Identifier: Apache-2.0
#include "pose_history.hpp"

namespace navigation {

void PoseHistory::add(const messages::Odometry& odometry) {
  if (!is_finite(odometry.pose) || !std::isfinite(odometry.time)) return;
  if (!empty() && odometry.time < newest().time) clear();
  if (count_ == kCapacity) {
    first_ = (first_ + 1) % kCapacity;
    --count_;
  }
  entries_[(first_ + count_) % kCapacity] = odometry;
  ++count_;
}

std::optional<Pose2D> PoseHistory::at(double time) const {
  if (empty() || !(time >= entry(0).time)) return std::nullopt;
  if (time >= newest().time) {
    const double ahead = time - newest().time;
    if (ahead > kLongestPrediction) return std::nullopt;
    return moved(newest().pose, newest().twist, ahead);
  }
  std::size_t after = count_ - 1;
  while (entry(after - 1).time > time)
    --after;
  const messages::Odometry& a = entry(after - 1);
  const messages::Odometry& b = entry(after);
  const double share = (time - a.time) / (b.time - a.time);
  return Pose2D{a.pose.x + share * (b.pose.x - a.pose.x), a.pose.y + share * (b.pose.y - a.pose.y),
                wrapped(a.pose.theta + share * wrapped(b.pose.theta - a.pose.theta))};
}

}  // namespace navigation
