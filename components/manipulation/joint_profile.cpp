// SPDX-License-Identifier: Apache-2.0
//
// A motion to a position consists of a change to a cruising velocity, of cruising, and of a stop. The way
// that both changes take together is a continuous function of the cruising velocity. So there always is a
// cruising velocity with which the remaining way is covered in a time that is not negative: either that of
// the limit, or one at which nothing remains. The one that is nearest to zero is taken. From there to zero
// every duration that is longer is found as well, which synchronises joints.
#include "joint_profile.hpp"

#include <algorithm>
#include <cmath>

namespace manipulation {
namespace {

constexpr double kSamePlace = 1e-9;  // rad or m

struct VelocityChange {
  std::array<double, 3> jerk{};
  std::array<double, 3> duration{};
  [[nodiscard]] double total() const { return duration[0] + duration[1] + duration[2]; }
};

VelocityChange change_of(const JointMotion& start, double velocity, const MotionLimits& limits) {
  const double direction = velocity >= settled_velocity(start, limits.jerk) ? 1 : -1;
  const double acceleration = direction * start.acceleration;
  const double gain = direction * (velocity - start.velocity);
  // Up to a peak, then down to zero. The square is negative by rounding only.
  const double square = limits.jerk * gain + 0.5 * acceleration * acceleration;
  double peak = std::sqrt(std::max(0.0, square));
  const bool clipped = peak > limits.acceleration;
  if (clipped) peak = limits.acceleration;
  const double rise = peak >= acceleration ? limits.jerk : -limits.jerk;
  const double risen = (peak * peak - acceleration * acceleration) / (2 * rise);
  const double fallen = peak * peak / (2 * limits.jerk);
  const double hold = clipped ? std::max(0.0, (gain - risen - fallen) / peak) : 0;
  return {{direction * rise, 0, -direction * limits.jerk},
          {std::abs(peak - acceleration) / limits.jerk, hold, peak / limits.jerk}};
}

JointMotion end_of(JointMotion motion, const VelocityChange& change) {
  for (std::size_t i = 0; i < 3; ++i)
    motion = after(motion, change.jerk[i], change.duration[i]);
  return motion;
}

}  // namespace

JointMotion after(const JointMotion& motion, double jerk, double duration) {
  const double t = duration;
  return {motion.position + t * (motion.velocity + t * (motion.acceleration / 2 + t * jerk / 6)),
          motion.velocity + t * (motion.acceleration + t * jerk / 2), motion.acceleration + t * jerk};
}

double settled_velocity(const JointMotion& motion, double jerk) {
  return motion.velocity + motion.acceleration * std::abs(motion.acceleration) / (2 * jerk);
}

/// The motions to a position for all cruising velocities.
class CruiseSearch {
 public:
  CruiseSearch(const JointMotion& start, double position, const MotionLimits& limits)
      : start_(start), position_(position), limits_(limits) {
    direction_ = remaining_at(0) >= 0 ? 1 : -1;
  }

  /// The cruising velocity, without its sign, that is nearest to zero and at which nothing is left to cruise.
  [[nodiscard]] double first_root() const {
    constexpr int kSamples = 24;
    double low = 0;
    double high = limits_.velocity;
    bool found = false;
    for (int i = 1; i <= kSamples && !found; ++i) {
      high = limits_.velocity * i / kSamples;
      found = !leaves_way(high);
      if (!found) low = high;
    }
    return found ? bisect(low, high, [this](double speed) { return leaves_way(speed); }) : low;
  }
  /// The cruising velocity below `fastest` with which it takes `duration` seconds.
  [[nodiscard]] double slower(double fastest, double duration) const {
    return bisect(0, fastest, [&](double speed) {
      return leaves_way(speed) && (speed == 0 || profile(speed).duration() >= duration);
    });
  }
  [[nodiscard]] JointProfile profile(double speed) const {
    const double velocity = direction_ * speed;
    const VelocityChange first = change_of(start_, velocity, limits_);
    const JointMotion cruising = end_of(start_, first);
    const VelocityChange stop = change_of({0, velocity, 0}, 0, limits_);
    const double left = position_ - end_of({cruising.position, velocity, 0}, stop).position;
    JointProfile made(start_);
    for (std::size_t i = 0; i < 3; ++i)
      made.append(first.jerk[i], first.duration[i]);
    if (speed > 0) made.append(0, std::max(0.0, left / velocity));
    for (std::size_t i = 0; i < 3; ++i)
      made.append(stop.jerk[i], stop.duration[i]);
    return made;
  }
  [[nodiscard]] bool at_rest_there() const { return std::abs(remaining_at(0)) < kSamePlace; }

 private:
  [[nodiscard]] double remaining_at(double velocity) const {
    const JointMotion cruising = end_of(start_, change_of(start_, velocity, limits_));
    const VelocityChange stop = change_of({0, velocity, 0}, 0, limits_);
    return position_ - end_of({cruising.position, velocity, 0}, stop).position;
  }
  [[nodiscard]] bool leaves_way(double speed) const {
    return direction_ * remaining_at(direction_ * speed) >= 0;
  }

  /// The border between the speeds for which `holds` is true, such as `low`, and those for which it is false,
  /// such as `high`; from the side where it is true.
  template <class Holds>
  static double bisect(double low, double high, Holds holds) {
    constexpr int kHalvings = 60;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (low + high);
      (holds(middle) ? low : high) = middle;
    }
    return low;
  }

  JointMotion start_;
  double position_;
  MotionLimits limits_;
  double direction_ = 1;
};

JointProfile JointProfile::to_velocity(const JointMotion& start, double velocity,
                                       const MotionLimits& limits) {
  const VelocityChange change = change_of(start, velocity, limits);
  JointProfile made(start);
  for (std::size_t i = 0; i < 3; ++i)
    made.append(change.jerk[i], change.duration[i]);
  return made;
}

JointProfile JointProfile::to_position(const JointMotion& start, double position,
                                       const MotionLimits& limits) {
  const CruiseSearch search(start, position, limits);
  return search.profile(search.at_rest_there() ? 0 : search.first_root());
}

JointProfile JointProfile::to_position_within(const JointMotion& start, double position,
                                              const MotionLimits& limits, double duration) {
  const CruiseSearch search(start, position, limits);
  if (search.at_rest_there()) return search.profile(0);
  const double fastest = search.first_root();
  const JointProfile first = search.profile(fastest);
  return first.duration() >= duration ? first : search.profile(search.slower(fastest, duration));
}

double JointProfile::duration() const {
  double sum = 0;
  for (std::size_t i = 0; i < count_; ++i)
    sum += parts_[i].duration;
  return sum;
}

JointMotion JointProfile::at(double time) const {
  JointMotion motion = start_;
  double left = std::max(0.0, time);
  for (std::size_t i = 0; i < count_; ++i) {
    const double part = std::min(left, parts_[i].duration);
    motion = after(motion, parts_[i].jerk, part);
    left -= part;
    if (left <= 0) return motion;
  }
  if (count_ > 0) motion.acceleration = 0;  // all profiles end without acceleration; this is rounding
  return after(motion, 0, left);
}

void JointProfile::append(double jerk, double duration) {
  if (duration > 0) parts_[count_++] = {jerk, duration};
}

}  // namespace manipulation
