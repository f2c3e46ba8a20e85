// SPDX-License-Identifier: Apache-2.0
#include "path_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace navigation {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
/// m, added to the radius: the path that is driven differs a little from the one that was wanted.
constexpr double kSideMargin = 0.02;

/// The speed from which `distance` suffices to stop, if the present speed lasts for another `step`.
double stopping_speed(double distance, double deceleration, double speed, double step) {
  const double left = distance - speed * step;
  return left <= 0 ? 0 : std::sqrt(2 * deceleration * left);
}

/// The turn rate towards an angle, from which it can stop there.
double turn_towards(double angle, const VehicleLimits& limits, double step) {
  const double rate = stopping_speed(std::abs(angle), 0.7 * limits.angular_acceleration, 0, step);
  return std::copysign(std::min({rate, limits.turn_rate, std::abs(angle) / step}), angle);
}

double distance_to(Point point, double curvature, double radius) {
  if (std::hypot(point.x, point.y) <= radius) return point.x > 0 ? 0 : kNever;
  if (std::abs(curvature) < 1e-6) {
    if (point.x <= 0 || std::abs(point.y) >= radius) return kNever;
    return point.x - std::sqrt(radius * radius - point.y * point.y);
  }
  // The vehicle drives around (0, turn); the point lies at `reach` from there, `ahead` of the vehicle.
  const double turn = 1 / curvature;
  const double circle = std::abs(turn);
  const double to_side = curvature > 0 ? turn - point.y : point.y - turn;
  const double reach = std::hypot(point.x, turn - point.y);
  const double share = (circle * circle + reach * reach - radius * radius) / (2 * circle * reach);
  if (!(std::abs(share) < 1)) return kNever;
  double ahead = std::atan2(point.x, to_side) - std::acos(share);
  if (ahead < 0) ahead += 2 * M_PI;
  return circle * ahead;
}

}  // namespace

void ObstaclePoints::set(const messages::LaserScan& scan, const Pose2D& sensor) {
  count_ = 0;
  if (points_.empty()) return;
  const std::size_t stride = scan.ranges.size() / (points_.size() + 1) + 1;
  for (std::size_t i = 0; i < scan.ranges.size(); i += stride) {
    const double range = scan.ranges[i];
    if (!(range >= scan.minimum_range && range <= scan.maximum_range) || count_ == points_.size()) continue;
    const double angle = sensor.theta + scan.first_angle + static_cast<double>(i) * scan.angle_step;
    points_[count_++] = {sensor.x + range * std::cos(angle), sensor.y + range * std::sin(angle)};
  }
}

double free_distance(std::span<const Point> points, double curvature, double radius) {
  double nearest = kNever;
  for (const Point& point : points)
    nearest = std::min(nearest, distance_to(point, curvature, radius));
  return nearest;
}

PathTracker::PathTracker(std::size_t most_poses) : poses_(most_poses), lengths_(most_poses) {}

bool PathTracker::set_path(const std::vector<Pose2D>& poses) {
  const bool fits = poses.size() <= poses_.size() && std::ranges::all_of(poses, is_finite);
  count_ = fits ? poses.size() : 0;
  std::copy_n(poses.begin(), count_, poses_.begin());
  length_ = 0;
  progress_ = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    if (i > 0) length_ += std::hypot(poses_[i].x - poses_[i - 1].x, poses_[i].y - poses_[i - 1].y);
    lengths_[i] = length_;
  }
  return fits;
}

void PathTracker::reset() {
  count_ = 0;
  length_ = 0;
  progress_ = 0;
  command_ = {};
  state_ = TrackerState::Idle;
}

Point PathTracker::point_at(double progress) const {
  const auto begin = lengths_.begin();
  const auto after = std::upper_bound(begin, begin + static_cast<std::ptrdiff_t>(count_), progress);
  const auto i = static_cast<std::size_t>(after - begin);
  if (i == 0) return {poses_[0].x, poses_[0].y};
  if (i == count_) return {poses_[count_ - 1].x, poses_[count_ - 1].y};
  const double share = (progress - lengths_[i - 1]) / (lengths_[i] - lengths_[i - 1]);
  return {poses_[i - 1].x + share * (poses_[i].x - poses_[i - 1].x),
          poses_[i - 1].y + share * (poses_[i].y - poses_[i - 1].y)};
}

/// Moves on to the nearest point of the path, but not farther than a metre, so that a path which comes back
/// close to itself is driven in its order.
void PathTracker::advance(const Pose2D& pose) {
  constexpr double kWindow = 1.0;  // m
  const double first = progress_;
  double nearest = kNever;
  for (std::size_t i = 1; i < count_ && lengths_[i - 1] <= first + kWindow; ++i) {
    if (lengths_[i] < first) continue;
    const double dx = poses_[i].x - poses_[i - 1].x;
    const double dy = poses_[i].y - poses_[i - 1].y;
    const double length = lengths_[i] - lengths_[i - 1];
    if (length <= 0) continue;
    const double along = ((pose.x - poses_[i - 1].x) * dx + (pose.y - poses_[i - 1].y) * dy) / length;
    const double place = std::clamp(lengths_[i - 1] + std::clamp(along, 0.0, length), first, first + kWindow);
    const Point point = point_at(place);
    const double distance = std::hypot(point.x - pose.x, point.y - pose.y);
    if (distance < nearest) {
      nearest = distance;
      progress_ = place;
    }
  }
}

PathTracker::Aim PathTracker::aim_at(const Pose2D& pose, double ahead, std::span<const Point> obstacles,
                                     double radius) const {
  const Point target = point_at(std::min(length_, progress_ + ahead));
  const Pose2D local = compose(inverse(pose), {target.x, target.y, 0});
  const double square = local.x * local.x + local.y * local.y;
  Aim aim;
  aim.heading = square > 0 ? std::atan2(local.y, local.x) : 0;
  aim.curvature = square > 1e-6 ? 2 * local.y / square : 0;
  aim.free = free_distance(obstacles, aim.curvature, radius + kSideMargin);
  return aim;
}

/// Where the arc to the point ahead is blocked, a nearer point leads closer along the path.
PathTracker::Aim PathTracker::choose(const Pose2D& pose, std::span<const Point> obstacles,
                                     const TrackerSettings& settings) const {
  constexpr int kTries = 3;
  Aim best;
  double ahead = settings.lookahead;
  for (int i = 0; i < kTries; ++i, ahead /= 2) {
    const Aim aim = aim_at(pose, ahead, obstacles, settings.radius);
    if (aim.free >= std::min(ahead, length_ - progress_) + settings.stop_distance) return aim;
    if (i == 0 || aim.free > best.free) best = aim;
  }
  return best;
}

messages::Twist2D PathTracker::wanted(const Pose2D& pose, std::span<const Point> obstacles,
                                      const TrackerSettings& settings, double step) {
  const VehicleLimits& limits = settings.limits;
  const Pose2D& end = poses_[count_ - 1];
  const double to_end = std::hypot(end.x - pose.x, end.y - pose.y);
  const double left = std::max(to_end, length_ - progress_);
  // Once it has arrived it stays, although braking and measuring move it a little.
  const double slack = state_ == TrackerState::Arrived ? 2 : 1;
  if (left <= slack * settings.tolerance) {
    const double turn = settings.final_heading ? wrapped(end.theta - pose.theta) : 0;
    const bool arrived = std::abs(turn) <= slack * settings.angle_tolerance;
    state_ = arrived ? TrackerState::Arrived : TrackerState::Driving;
    return {0, arrived ? 0 : turn_towards(turn, limits, step)};
  }
  state_ = TrackerState::Driving;
  const Aim aim = choose(pose, obstacles, settings);
  if (std::abs(aim.heading) > settings.turn_on_spot) return {0, turn_towards(aim.heading, limits, step)};

  constexpr double kCrawl = 0.02;  // m/s; slower than this is standing
  const double speed_now = command_.linear;
  const double until_obstacle =
      stopping_speed(aim.free - settings.stop_distance, 0.8 * limits.deceleration, speed_now, step);
  if (until_obstacle < kCrawl) {
    // Turning touches nothing, and the straight way may be free.
    constexpr double kAhead = 0.1;  // rad
    if (std::abs(aim.heading) > kAhead) return {0, turn_towards(aim.heading, limits, step)};
    state_ = TrackerState::Blocked;
    return {};
  }
  const double until_end = stopping_speed(left, 0.5 * limits.deceleration, speed_now, step);
  const double bend = std::abs(aim.curvature);
  double speed = std::min({limits.speed, until_obstacle, std::max(until_end, kCrawl)});
  if (bend > 0) speed = std::min(speed, limits.turn_rate / bend);
  return {speed, speed * aim.curvature};
}

messages::Twist2D PathTracker::limited(messages::Twist2D wanted, const VehicleLimits& limits, double step) {
  const double slower = limits.deceleration * step;
  const double faster = limits.acceleration * step;
  const double turn = limits.angular_acceleration * step;
  command_.linear =
      std::clamp(wanted.linear, std::max(0.0, command_.linear - slower), command_.linear + faster);
  command_.linear = std::clamp(command_.linear, 0.0, limits.speed);
  command_.angular = std::clamp(wanted.angular, command_.angular - turn, command_.angular + turn);
  command_.angular = std::clamp(command_.angular, -limits.turn_rate, limits.turn_rate);
  return command_;
}

messages::Twist2D PathTracker::update(const Pose2D& pose, std::span<const Point> obstacles,
                                      const TrackerSettings& settings, double step) {
  if (count_ == 0 || !is_finite(pose)) {
    state_ = TrackerState::Idle;
    return limited({}, settings.limits, step);
  }
  advance(pose);
  return limited(wanted(pose, obstacles, settings, step), settings.limits, step);
}

messages::Twist2D PathTracker::brake(const TrackerSettings& settings, double step) {
  return limited({}, settings.limits, step);
}

}  // namespace navigation
