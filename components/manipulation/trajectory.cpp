// SPDX-License-Identifier: Apache-2.0
#include "trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace manipulation {

segue::Result<Trajectory> Trajectory::create(std::span<const JointLimits> limits) {
  if (limits.empty() || limits.size() > kMostJoints) {
    return segue::fail(segue::ErrorCode::InvalidArgument, "limits of 1 to " + std::to_string(kMostJoints) +
                                                              " joints are needed, these are of " +
                                                              std::to_string(limits.size()));
  }
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const JointLimits& joint = limits[i];
    const auto usable = [](double limit) { return limit > 0 && std::isfinite(limit); };
    if (!usable(joint.motion.velocity) || !usable(joint.motion.acceleration) || !usable(joint.motion.jerk) ||
        !(joint.lower <= joint.upper)) {
      return segue::fail(
          segue::ErrorCode::InvalidArgument,
          "joint " + std::to_string(i) +
              ": limits of velocity, acceleration and jerk must be positive, and the lower limit "
              "of its position must not exceed the upper one");
    }
  }
  Trajectory made;
  made.count_ = limits.size();
  std::ranges::copy(limits, made.limits_.begin());
  return made;
}

bool Trajectory::at_rest() const {
  constexpr double kStill = 1e-9;
  return std::all_of(motions_.begin(), motions_.begin() + static_cast<std::ptrdiff_t>(count_),
                     [](const JointMotion& motion) {
                       return std::abs(motion.velocity) < kStill && std::abs(motion.acceleration) < kStill;
                     });
}

void Trajectory::begin(std::span<const JointMotion> motions) {
  std::copy_n(motions.begin(), std::min(motions.size(), count_), motions_.begin());
  stop();
}

bool Trajectory::usable(std::span<const double> values) const {
  return values.size() == count_ &&
         std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

bool Trajectory::move_to(std::span<const double> positions) {
  if (!usable(positions)) return false;
  double duration = 0;
  const auto plan = [&](std::size_t i) {
    const double target = std::clamp(positions[i], limits_[i].lower, limits_[i].upper);
    profiles_[i] = JointProfile::to_position_within(motions_[i], target, limits_[i].motion, duration);
  };
  // The slowest joint tells how long all of them take. To meet that a joint may have to take even longer.
  constexpr int kRounds = 4;
  for (int round = 0; round < kRounds; ++round) {
    const double before = duration;
    for (std::size_t i = 0; i < count_; ++i)
      plan(i);
    for (std::size_t i = 0; i < count_; ++i)
      duration = std::max(duration, profiles_[i].duration());
    if (duration <= before + 1e-9) break;
  }
  time_ = 0;
  return true;
}

/// A motion with this velocity to the end of the joint's range, where it stops.
JointProfile Trajectory::towards_end(std::size_t joint, double velocity) const {
  const JointLimits& limits = limits_[joint];
  const double wanted = std::clamp(velocity, -limits.motion.velocity, limits.motion.velocity);
  const double end = wanted > 0 ? limits.upper : limits.lower;
  constexpr double kSlowest = 1e-9;  // below, a joint that is to move stands
  if (std::abs(wanted) < kSlowest || !std::isfinite(end))
    return JointProfile::to_velocity(motions_[joint], wanted, limits.motion);
  MotionLimits slower = limits.motion;
  slower.velocity = std::abs(wanted);
  return JointProfile::to_position(motions_[joint], end, slower);
}

bool Trajectory::move_with(std::span<const double> velocities) {
  if (!usable(velocities)) return false;
  for (std::size_t i = 0; i < count_; ++i)
    profiles_[i] = towards_end(i, velocities[i]);
  time_ = 0;
  return true;
}

void Trajectory::stop() {
  for (std::size_t i = 0; i < count_; ++i)
    profiles_[i] = JointProfile::to_velocity(motions_[i], 0, limits_[i].motion);
  time_ = 0;
}

void Trajectory::step(double seconds) {
  time_ += std::max(0.0, seconds);
  for (std::size_t i = 0; i < count_; ++i)
    motions_[i] = profiles_[i].at(time_);
}

}  // namespace manipulation
