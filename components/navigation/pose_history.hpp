// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pose2d.hpp"

#include <array>
#include <cstddef>
#include <optional>

namespace navigation {

/// Where a vehicle was in the recent past, so that a scan is used with the pose at which it was taken. Never
/// allocates. One thread at a time.
class PoseHistory {
 public:
  /// Entries must come in the order of their times; one that is older than the newest, as after a restart of
  /// a simulation, begins a new history. Entries that are not finite are ignored.
  void add(const messages::Odometry& odometry);
  void clear() { count_ = 0; }
  [[nodiscard]] bool empty() const { return count_ == 0; }
  /// Requires that it is not empty.
  [[nodiscard]] const messages::Odometry& newest() const { return entry(count_ - 1); }
  /// The pose at a time (s), interpolated, or up to half a second after the newest entry continued with its
  /// velocity. Nothing for other times.
  [[nodiscard]] std::optional<Pose2D> at(double time) const;

 private:
  static constexpr std::size_t kCapacity = 128;
  static constexpr double kLongestPrediction = 0.5;  // s
  [[nodiscard]] const messages::Odometry& entry(std::size_t age) const {
    return entries_[(first_ + age) % kCapacity];
  }

  std::array<messages::Odometry, kCapacity> entries_{};
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

}  // namespace navigation
