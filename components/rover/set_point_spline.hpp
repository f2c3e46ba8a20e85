// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace rover {

/// The motion of one joint between its set points, as a servo drive interpolates them: the uniform cubic
/// B-spline whose control points are the set points. Its velocity, acceleration and jerk are averages of the
/// first, second and third differences of the set points, so what limits these limits the motion, and it
/// never overshoots. It lags two periods of the set points behind. Never allocates. One thread at a time.
class SetPointSpline {
 public:
  /// At rest. There are `steps` >= 1 steps of `step` s in each period of the set points.
  SetPointSpline(double position, int steps, double step);

  /// Moves on by one step. In the first step of each period the set point becomes the last control point.
  void advance(double set_point);
  /// Before the last step; rad.
  [[nodiscard]] double position() const { return position_; }
  /// During the last step; rad/s.
  [[nodiscard]] double velocity() const { return velocity_; }
  /// By which the velocity changed at the last step; rad/s^2.
  [[nodiscard]] double acceleration() const { return acceleration_; }

 private:
  std::array<double, 4> points_;
  int steps_;
  double step_;
  int taken_;  ///< steps in this period
  double position_;
  double next_;  ///< after the last step
  double velocity_ = 0;
  double acceleration_ = 0;
};

}  // namespace rover
