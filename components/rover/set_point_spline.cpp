// SPDX-License-Identifier: Apache-2.0
#include "set_point_spline.hpp"

#include <algorithm>

namespace rover {

SetPointSpline::SetPointSpline(double position, int steps, double step)
    : steps_(steps), step_(step), taken_(steps), position_(position), next_(position) {
  points_.fill(position);
}

void SetPointSpline::advance(double set_point) {
  if (taken_ == steps_) {
    std::shift_left(points_.begin(), points_.end(), 1);
    points_.back() = set_point;
    taken_ = 0;
  }
  ++taken_;
  const double u = static_cast<double>(taken_) / steps_;
  const double rest = 1 - u;
  // As a sum of what changes: set points that are equal give just that position, without rounding.
  const double first = rest * rest * rest / 6;
  const double last = u * u * u / 6;
  const double third = (1 + 3 * u + 3 * u * u - 3 * u * u * u) / 6;
  position_ = next_;
  next_ = points_[1] + first * (points_[0] - points_[1]) + third * (points_[2] - points_[1]) +
          last * (points_[3] - points_[1]);
  const double before = velocity_;
  velocity_ = (next_ - position_) / step_;
  acceleration_ = (velocity_ - before) / step_;
}

}  // namespace rover
