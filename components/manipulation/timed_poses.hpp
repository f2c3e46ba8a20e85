// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../messages/recent_samples.hpp"
#include "pose_servo.hpp"

#include <optional>

namespace manipulation {

/// Where something was in the recent past, so that what a camera has seen is used with the pose from which it
/// saw it. Never allocates. One thread at a time.
class TimedPoses {
 public:
  /// In the order of their times, as of RecentSamples. Poses that are not finite, or without an orientation,
  /// are ignored.
  void add(const messages::TimedPose& entry);
  void clear() { entries_.clear(); }
  /// The pose at a time (s), interpolated; the newest one for later times. Nothing for times before the
  /// oldest.
  [[nodiscard]] std::optional<Pose> at(double time) const;

 private:
  messages::RecentSamples<messages::TimedPose> entries_;
};

}  // namespace manipulation
