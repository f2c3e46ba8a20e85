// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pose_servo.hpp"

#include <array>
#include <cstddef>
#include <optional>

namespace manipulation {

/// Where something was in the recent past, so that what a camera has seen is used with the pose from which it
/// saw it. Never allocates. One thread at a time.
class TimedPoses {
 public:
  /// Entries must come in the order of their times; one that is older than the newest, as after a restart of
  /// a simulation, begins anew. Poses that are not finite, or without an orientation, are ignored.
  void add(const messages::TimedPose& entry);
  void clear() { count_ = 0; }
  /// The pose at a time (s), interpolated; the newest one for later times. Nothing for times before the
  /// oldest.
  [[nodiscard]] std::optional<Pose> at(double time) const;

 private:
  static constexpr std::size_t kCapacity = 128;
  [[nodiscard]] const messages::TimedPose& entry(std::size_t number) const {
    return entries_[(first_ + number) % kCapacity];
  }

  std::array<messages::TimedPose, kCapacity> entries_{};
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

}  // namespace manipulation
