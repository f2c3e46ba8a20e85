// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pose2d.hpp"

#include "../messages/sensors.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace navigation {

struct VehicleLimits {
  double speed = 0.5;                 ///< m/s
  double turn_rate = 1.2;             ///< rad/s
  double acceleration = 0.5;          ///< m/s^2
  double deceleration = 1.0;          ///< m/s^2
  double angular_acceleration = 3.0;  ///< rad/s^2
};

struct TrackerSettings {
  VehicleLimits limits;
  /// m, of the circle around the vehicle that must not touch anything; to be driven, a way must be 2 cm wider
  /// on either side.
  double radius = 0.25;
  double stop_distance = 0.05;   ///< m; where it comes to rest in front of an obstacle
  double lookahead = 0.4;        ///< m along the path to the point that is driven at
  double turn_on_spot = 0.9;     ///< rad; farther away from its heading it turns before it drives
  double tolerance = 0.08;       ///< m; how close to the end of the path it has arrived
  double angle_tolerance = 0.1;  ///< rad; how close to the heading of the last pose it has arrived
  bool final_heading = true;     ///< whether it turns to the heading of the last pose
};

enum class TrackerState : std::uint8_t { Idle, Driving, Arrived, Blocked };

/// The points of a laser scan around a vehicle. Never allocates after construction. One thread at a time.
class ObstaclePoints {
 public:
  explicit ObstaclePoints(std::size_t most_points) : points_(most_points) {}
  /// The scan of a scanner that is mounted at `sensor` on the vehicle, in the vehicle's frame. Points beyond
  /// the capacity are left out evenly: every second, third ... beam is taken.
  void set(const messages::LaserScan& scan, const Pose2D& sensor);
  void clear() { count_ = 0; }
  [[nodiscard]] std::span<const Point> points() const { return {points_.data(), count_}; }

 private:
  std::vector<Point> points_;
  std::size_t count_ = 0;
};

/// How far a vehicle can drive on an arc until its circle touches one of the points; infinite if it never
/// does, 0 if it touches one already and would drive at it. Curvature in 1/m, positive to the left.
[[nodiscard]] double free_distance(std::span<const Point> points, double curvature, double radius);

/// Follows a path with a vehicle that can turn on the spot: pure pursuit (Coulter 1992), speeds from which it
/// can stop at the end of the path and in front of obstacles. The constructor allocates, nothing else does.
/// One thread at a time.
class PathTracker {
 public:
  explicit PathTracker(std::size_t most_poses);

  /// Follows another path; an empty one ends the drive. False, and as if it were empty, if it has too many
  /// poses.
  bool set_path(const std::vector<Pose2D>& poses);
  /// The velocity to command for the next `step` seconds. It and its change obey the limits, provided that
  /// the settings do not change.
  messages::Twist2D update(const Pose2D& pose, std::span<const Point> obstacles,
                           const TrackerSettings& settings, double step);
  /// The velocity to command for the next `step` seconds where pose or obstacles are not known: brakes.
  messages::Twist2D brake(const TrackerSettings& settings, double step);
  /// Forgets path and velocity: the vehicle stands.
  void reset();
  [[nodiscard]] TrackerState state() const { return state_; }
  /// m, along the path to its end.
  [[nodiscard]] double remaining() const { return length_ - progress_; }

 private:
  struct Aim {
    double curvature = 0;  ///< 1/m
    double heading = 0;    ///< rad, of the point that is driven at, from the vehicle's heading
    double free = 0;       ///< m that can be driven on this arc
  };
  void advance(const Pose2D& pose);
  [[nodiscard]] Point point_at(double progress) const;
  [[nodiscard]] Aim aim_at(const Pose2D& pose, double ahead, std::span<const Point> obstacles,
                           double radius) const;
  [[nodiscard]] Aim choose(const Pose2D& pose, std::span<const Point> obstacles,
                           const TrackerSettings& settings) const;
  [[nodiscard]] messages::Twist2D wanted(const Pose2D& pose, std::span<const Point> obstacles,
                                         const TrackerSettings& settings, double step);
  messages::Twist2D limited(messages::Twist2D wanted, const VehicleLimits& limits, double step);

  std::vector<Pose2D> poses_;
  std::vector<double> lengths_;  ///< of the path up to each pose
  std::size_t count_ = 0;
  double length_ = 0;
  double progress_ = 0;  ///< m along the path to the point that is nearest to the vehicle
  messages::Twist2D command_;
  TrackerState state_ = TrackerState::Idle;
};

}  // namespace navigation
