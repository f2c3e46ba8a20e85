// SPDX-License-Identifier: Apache-2.0
#include "pose_filter.hpp"

#include <algorithm>
#include <cmath>

namespace manipulation {
namespace {

double distance(const Pose& a, const Pose& b) {
  return (a.position - b.position).norm();
}

}  // namespace

bool PoseFilter::add(const Pose& measured, double seconds, const PoseFilterSettings& settings) {
  if (estimate_ && distance(*estimate_, measured) > settings.largest_jump) {
    doubts_ = doubts_ > 0 && distance(doubted_, measured) <= settings.largest_jump ? doubts_ + 1 : 1;
    doubted_ = measured;
    if (doubts_ < settings.confirmations) return false;
    estimate_.reset();
  }
  doubts_ = 0;
  if (!estimate_) {
    estimate_ = measured;
    return true;
  }
  const double share =
      settings.time_constant > 0 ? 1 - std::exp(-std::max(0.0, seconds) / settings.time_constant) : 1;
  estimate_->position += share * (measured.position - estimate_->position);
  estimate_->orientation = estimate_->orientation.slerp(share, measured.orientation).normalized();
  return true;
}

}  // namespace manipulation
