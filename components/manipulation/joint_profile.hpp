// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

/// Motions of one joint with bounded jerk. Real-time safe; any thread.
namespace manipulation {

/// The state of one joint, in rad (or m) and seconds.
struct JointMotion {
  double position = 0;
  double velocity = 0;
  double acceleration = 0;
};

struct MotionLimits {
  double velocity = 1;      ///< rad/s, all positive
  double acceleration = 3;  ///< rad/s^2
  double jerk = 30;         ///< rad/s^3
};

/// `motion` after `duration` seconds with a constant jerk.
[[nodiscard]] JointMotion after(const JointMotion& motion, double jerk, double duration);

/// Where and how fast the joint is once its acceleration has been taken back to zero as fast as possible: the
/// velocity that cannot be avoided.
[[nodiscard]] double settled_velocity(const JointMotion& motion, double jerk);

/// A motion of up to seven parts with constant jerk, then at the velocity in which they end.
class JointProfile {
 public:
  /// Stays where `start` is, if that is at rest, or moves on with its velocity and acceleration.
  JointProfile() = default;
  explicit JointProfile(const JointMotion& start) : start_(start) {}

  /// A motion to a velocity in the shortest time, which then goes on with it. Its velocities lie between the
  /// present and the wanted one, but for what the present acceleration makes unavoidable.
  static JointProfile to_velocity(const JointMotion& start, double velocity, const MotionLimits& limits);
  /// A motion to rest at a position, over a phase of constant velocity. Its duration is the shortest of such
  /// motions whose cruising velocity does not exceed the limit and grows from zero (or very close to it; see
  /// the source). Keeps the limits that `start` keeps; what exceeds them is brought back first.
  static JointProfile to_position(const JointMotion& start, double position, const MotionLimits& limits);
  /// A motion like that of to_position(), but in `duration` seconds, or in to_position()'s duration if that
  /// is longer.
  static JointProfile to_position_within(const JointMotion& start, double position,
                                         const MotionLimits& limits, double duration);

  /// The time from its beginning until it is at rest or at its final velocity, s.
  [[nodiscard]] double duration() const;
  /// The motion `time` seconds after its beginning.
  [[nodiscard]] JointMotion at(double time) const;

 private:
  friend class CruiseSearch;
  void append(double jerk, double duration);

  struct Part {
    double jerk = 0;
    double duration = 0;
  };
  JointMotion start_;
  std::array<Part, 7> parts_{};
  std::size_t count_ = 0;
};

}  // namespace manipulation
