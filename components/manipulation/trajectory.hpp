// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "joint_profile.hpp"

#include <segue/base/result.hpp>

#include <array>
#include <cstddef>
#include <span>

namespace manipulation {

inline constexpr std::size_t kMostJoints = 16;

struct JointLimits {
  double lower = -3.1;  ///< rad or m; minus and plus infinity for joints that turn endlessly
  double upper = 3.1;
  MotionLimits motion;
};

/// Set points for a group of joints that never violate limits of position, velocity, acceleration and jerk,
/// whatever is commanded and when. Commands may come at any time; each begins with the present motion. Never
/// allocates. One thread at a time.
class Trajectory {
 public:
  /// InvalidArgument unless there are 1 to kMostJoints joints, with positive limits and lower <= upper.
  static segue::Result<Trajectory> create(std::span<const JointLimits> limits);

  [[nodiscard]] std::size_t size() const { return count_; }
  /// The present motion of a joint.
  [[nodiscard]] const JointMotion& motion(std::size_t joint) const { return motions_[joint]; }
  [[nodiscard]] bool at_rest() const;

  /// Begins at this motion, one entry per joint, and comes to rest as soon as the limits allow. Motions that
  /// violate the limits are brought back.
  void begin(std::span<const JointMotion> motions);
  /// All joints arrive at their positions, at rest, at the same time. Positions are limited to the joints'
  /// ranges. False, and no change, unless there is a finite position for each joint.
  [[nodiscard]] bool move_to(std::span<const double> positions);
  /// Each joint takes on its velocity, and stops where its range ends. Velocities are limited as well. False,
  /// and no change, unless there is a finite velocity for each joint.
  [[nodiscard]] bool move_with(std::span<const double> velocities);
  /// Comes to rest as soon as the limits allow.
  void stop();
  /// Moves on by `seconds` >= 0.
  void step(double seconds);

 private:
  Trajectory() = default;
  [[nodiscard]] bool usable(std::span<const double> values) const;
  [[nodiscard]] JointProfile towards_end(std::size_t joint, double velocity) const;

  std::size_t count_ = 0;
  std::array<JointLimits, kMostJoints> limits_{};
  std::array<JointMotion, kMostJoints> motions_{};
  std::array<JointProfile, kMostJoints> profiles_{};
  double time_ = 0;  ///< since the profiles began
};

}  // namespace manipulation
