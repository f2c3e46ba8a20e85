// SPDX-License-Identifier: Apache-2.0
#include "pose_history.hpp"

namespace navigation {

void PoseHistory::add(const messages::Odometry& odometry) {
  if (is_finite(odometry.pose)) entries_.add(odometry);
}

std::optional<Pose2D> PoseHistory::at(double time) const {
  if (empty() || !(time >= entries_.oldest().time)) return std::nullopt;
  if (time >= newest().time) {
    const double ahead = time - newest().time;
    if (ahead > kLongestPrediction) return std::nullopt;
    return moved(newest().pose, newest().twist, ahead);
  }
  const auto [a, b, share] = entries_.around(time);
  return Pose2D{a.pose.x + share * (b.pose.x - a.pose.x), a.pose.y + share * (b.pose.y - a.pose.y),
                wrapped(a.pose.theta + share * wrapped(b.pose.theta - a.pose.theta))};
}

}  // namespace navigation
