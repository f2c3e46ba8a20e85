// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pose_servo.hpp"

#include <optional>

namespace manipulation {

struct PoseFilterSettings {
  double time_constant = 0.2;  ///< s: how slowly it follows; 0: not filtered
  double largest_jump = 0.1;   ///< m from the present estimate; what is farther away is doubted
  int confirmations = 5;       ///< doubted poses in a row, close to each other, that are believed after all
};

/// Smooths measured poses of something that rests or moves slowly, and leaves out single wrong ones. Never
/// allocates. One thread at a time.
class PoseFilter {
 public:
  /// Takes a measurement made `seconds` after the last one. False if it was doubted.
  bool add(const Pose& measured, double seconds, const PoseFilterSettings& settings);
  /// Nothing before the first measurement.
  [[nodiscard]] const std::optional<Pose>& estimate() const { return estimate_; }
  void reset() { *this = {}; }

 private:
  std::optional<Pose> estimate_;
  Pose doubted_;
  int doubts_ = 0;
};

}  // namespace manipulation
