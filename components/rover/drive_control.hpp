// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drive_kinematics.hpp"
#include "types.hpp"

namespace rover {

/// Set points for the wheels from a wanted velocity. Wheels that have to be steered by much are steered while
/// the rover stands, as they would slip otherwise. Plain computations: any thread, one at a time; real-time
/// safe.
class DriveControl {
 public:
  /// The largest accelerations: m/s^2 and rad/s^2.
  explicit DriveControl(const messages::Twist2D& acceleration = {1.0, 3.0}) : acceleration_(acceleration) {}

  /// `steering`: where the wheels point now; `step`: seconds since the last call. The time of the result is
  /// zero.
  WheelCommand advance(const messages::Twist2D& wanted, const PerWheel& steering, double step);
  /// The velocity that is commanded now.
  [[nodiscard]] const messages::Twist2D& twist() const { return twist_; }

 private:
  messages::Twist2D acceleration_;
  messages::Twist2D twist_;
};

}  // namespace rover
