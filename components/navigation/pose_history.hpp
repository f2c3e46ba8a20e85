// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../messages/recent_samples.hpp"
#include "pose2d.hpp"

#include <optional>

namespace navigation {

/// Where a vehicle was in the recent past, so that a scan is used with the pose at which it was taken. Never
/// allocates. One thread at a time.
class PoseHistory {
 public:
  /// In the order of their times, as of RecentSamples. Entries that are not finite are ignored.
  void add(const messages::Odometry& odometry);
  void clear() { entries_.clear(); }
  [[nodiscard]] bool empty() const { return entries_.empty(); }
  /// Requires that it is not empty.
  [[nodiscard]] const messages::Odometry& newest() const { return entries_.newest(); }
  /// The pose at a time (s), interpolated, or up to half a second after the newest entry continued with its
  /// velocity. Nothing for other times.
  [[nodiscard]] std::optional<Pose2D> at(double time) const;

 private:
  static constexpr double kLongestPrediction = 0.5;  // s

  messages::RecentSamples<messages::Odometry> entries_;
};

}  // namespace navigation
