// SPDX-License-Identifier: Apache-2.0
#include "drive_kinematics.hpp"

#include "rover_model.hpp"

#include <cmath>

namespace rover {
namespace {

/// The velocity of a wheel's axle in the frame of the rover.
std::array<double, 2> velocity_at(const WheelPlace& place, const messages::Twist2D& twist) {
  return {twist.linear - twist.angular * place.y, twist.angular * place.x};
}

}  // namespace

PerWheel steering_for(const messages::Twist2D& twist, const PerWheel& steering) {
  constexpr double kStill = 1e-4;  // m/s
  PerWheel wanted = steering;
  for (std::size_t wheel = 0; wheel < wanted.size(); ++wheel) {
    const auto velocity = velocity_at(kWheelPlaces.at(wheel), twist);
    if (std::hypot(velocity[0], velocity[1]) < kStill) continue;
    const double angle = std::remainder(std::atan2(velocity[1], velocity[0]), M_PI);
    const double other = angle > 0 ? angle - M_PI : angle + M_PI;
    const double now = steering.at(wheel);
    const bool other_way =
        std::abs(other) <= kLargestSteering && std::abs(other - now) < std::abs(angle - now);
    wanted.at(wheel) = other_way ? other : angle;
  }
  return wanted;
}

PerWheel speeds_for(const messages::Twist2D& twist, const PerWheel& steering) {
  PerWheel speeds{};
  for (std::size_t wheel = 0; wheel < speeds.size(); ++wheel) {
    const auto velocity = velocity_at(kWheelPlaces.at(wheel), twist);
    const double angle = steering.at(wheel);
    speeds.at(wheel) = (velocity[0] * std::cos(angle) + velocity[1] * std::sin(angle)) / kWheelRadius;
  }
  return speeds;
}

messages::Pose2D movement_of(const PerWheel& angles, const PerWheel& steering) {
  messages::Pose2D movement;
  double squares = 0;
  for (std::size_t wheel = 0; wheel < angles.size(); ++wheel) {
    const WheelPlace& place = kWheelPlaces.at(wheel);
    const double along = angles.at(wheel) * kWheelRadius * std::cos(steering.at(wheel));
    const double aside = angles.at(wheel) * kWheelRadius * std::sin(steering.at(wheel));
    // The wheels lie symmetrically about the origin, so that the normal equations are diagonal.
    movement.x += along / static_cast<double>(kWheels);
    movement.y += aside / static_cast<double>(kWheels);
    movement.theta += place.x * aside - place.y * along;
    squares += place.x * place.x + place.y * place.y;
  }
  movement.theta /= squares;
  return movement;
}

messages::Pose2D moved(const messages::Pose2D& pose, const messages::Pose2D& movement) {
  const double heading = pose.theta + movement.theta / 2;
  return {pose.x + movement.x * std::cos(heading) - movement.y * std::sin(heading),
          pose.y + movement.x * std::sin(heading) + movement.y * std::cos(heading),
          std::remainder(pose.theta + movement.theta, 2 * M_PI)};
}

}  // namespace rover
