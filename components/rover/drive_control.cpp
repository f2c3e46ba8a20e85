// SPDX-License-Identifier: Apache-2.0
#include "drive_control.hpp"

#include <algorithm>
#include <cmath>

namespace rover {
namespace {

double largest_difference(const PerWheel& one, const PerWheel& other) {
  double largest = 0;
  for (std::size_t wheel = 0; wheel < one.size(); ++wheel)
    largest = std::max(largest, std::abs(one.at(wheel) - other.at(wheel)));
  return largest;
}

/// `twist`, changed towards `wanted` by no more than `most`.
messages::Twist2D approached(const messages::Twist2D& twist, const messages::Twist2D& wanted,
                             const messages::Twist2D& most) {
  return {twist.linear + std::clamp(wanted.linear - twist.linear, -most.linear, most.linear),
          twist.angular + std::clamp(wanted.angular - twist.angular, -most.angular, most.angular)};
}

}  // namespace

WheelCommand DriveControl::advance(const messages::Twist2D& wanted, const PerWheel& steering, double step) {
  constexpr double kLargestChange = 0.3;  // rad, while it moves
  const PerWheel wanted_steering = steering_for(wanted, steering);
  const bool far = largest_difference(wanted_steering, steering) > kLargestChange;
  const bool moving = twist_.linear != 0 || twist_.angular != 0;
  const PerWheel next_steering = far && moving ? steering : wanted_steering;
  twist_ = approached(twist_, far ? messages::Twist2D{} : wanted,
                      {acceleration_.linear * step, acceleration_.angular * step});
  return {0, next_steering, speeds_for(twist_, steering)};
}

}  // namespace rover
