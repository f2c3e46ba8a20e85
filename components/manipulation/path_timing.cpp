// SPDX-License-Identifier: Apache-2.0
#include "path_timing.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace manipulation {
namespace {

using Point = Eigen::VectorXd;

constexpr double kSame = 1e-6;      // rad; points that are closer are one
constexpr double kSpacing = 0.004;  // rad, between points at which velocities are computed
constexpr double kLongest = 600;    // s
constexpr double kCornering = 0.7;  // part of the acceleration that a curve may take
constexpr double kPlanned =
    0.9;  // part of the acceleration that is used: the points are not infinitely close

segue::Error refusal(std::string what) {
  return {segue::ErrorCode::InvalidArgument, std::move(what), {}, {}, {}};
}

segue::Result<std::vector<Point>> checked(const std::vector<std::vector<double>>& points,
                                          std::span<const JointLimits> limits) {
  constexpr double kSlack = 1e-6;  // rad
  if (points.empty()) return refusal("a path needs points");
  std::vector<Point> path;
  for (std::size_t index = 0; index < points.size(); ++index) {
    const auto& positions = points[index];
    const std::string where = "point " + std::to_string(index + 1);
    if (positions.size() != limits.size()) {
      return refusal(where + " has " + std::to_string(positions.size()) + " positions for " +
                     std::to_string(limits.size()) + " joints");
    }
    for (std::size_t joint = 0; joint < limits.size(); ++joint) {
      if (!(positions[joint] >= limits[joint].lower - kSlack &&
            positions[joint] <= limits[joint].upper + kSlack))
        return refusal(where + ": joint " + std::to_string(joint + 1) + " does not reach that far");
    }
    Point point = Eigen::Map<const Point>(positions.data(), static_cast<Eigen::Index>(positions.size()));
    if (path.empty() || (point - path.back()).norm() > kSame) path.push_back(std::move(point));
  }
  return path;
}

/// The path with rounded corners as points that lie close together.
class DensePath {
 public:
  DensePath(const std::vector<Point>& path, double corner) {
    points_.push_back(path.front());
    for (std::size_t index = 1; index + 1 < path.size(); ++index)
      round(path[index - 1], path[index], path[index + 1], corner);
    if (path.size() > 1) line_to(path.back());
  }
  std::vector<Point> take() { return std::move(points_); }

 private:
  void line_to(const Point& end) {
    const Point begin = points_.back();
    const int steps = std::max(1, static_cast<int>(std::ceil((end - begin).norm() / kSpacing)));
    if ((end - begin).norm() < kSame / 10) return;
    for (int step = 1; step <= steps; ++step)
      points_.push_back(begin + (end - begin) * step / steps);
  }

  void round(const Point& before, const Point& at, const Point& after, double corner) {
    const Point in = (at - before).normalized();
    const Point out = (after - at).normalized();
    const double turn = (out - in).norm();
    const double space = std::min((at - before).norm(), (after - at).norm()) / 2;
    // The middle of the parabola is a quarter of cut * (out - in) away from the corner.
    const double cut = turn < 1e-9 ? 0 : std::min(space, 4 * corner / turn);
    line_to(at - cut * in);
    if (cut < kSame) return;
    const Point begin = points_.back();
    const int steps = std::max(4, static_cast<int>(std::ceil(2 * cut / kSpacing)));
    for (int step = 1; step <= steps; ++step) {
      const double t = static_cast<double>(step) / steps;
      points_.push_back((1 - t) * (1 - t) * begin + 2 * t * (1 - t) * at + t * t * (at + cut * out));
    }
  }

  std::vector<Point> points_;
};

/// When each of the points is passed, as fast as velocities and accelerations allow.
class FastestPass {
 public:
  FastestPass(const std::vector<Point>& points, std::span<const JointLimits> limits)
      : limits_(limits), speeds_(points.size(), 0), along_(points.size()), curve_(points.size()) {
    for (std::size_t index = 0; index < points.size(); ++index)
      describe(points, index);
    for (std::size_t index = 0; index + 1 < points.size(); ++index)
      lengths_.push_back((points[index + 1] - points[index]).norm());
    for (std::size_t index = 1; index + 1 < points.size(); ++index)
      speeds_[index] = fastest(index);
    for (std::size_t index = 1; index < points.size(); ++index)
      limit(index, index - 1, lengths_[index - 1]);
    for (std::size_t index = points.size(); index-- > 1;)
      limit(index - 1, index, lengths_[index - 1]);
    for (std::size_t index = 0; index < lengths_.size(); ++index)
      times_.push_back(times_.back() + 2 * lengths_[index] / (speeds_[index] + speeds_[index + 1]));
  }

  [[nodiscard]] const std::vector<double>& times() const { return times_; }
  [[nodiscard]] const std::vector<double>& speeds() const { return speeds_; }

 private:
  /// Derivatives of the positions with respect to the length of the path.
  void describe(const std::vector<Point>& points, std::size_t index) {
    const std::size_t last = points.size() - 1;
    const Point& before = points[index == 0 ? 0 : index - 1];
    const Point& after = points[std::min(index + 1, last)];
    along_[index] = (after - before).normalized();
    curve_[index] = Point::Zero(points[index].size());
    if (index == 0 || index == last) return;
    const double in = (points[index] - before).norm();
    const double out = (after - points[index]).norm();
    curve_[index] = ((after - points[index]) / out - (points[index] - before) / in) * 2 / (in + out);
  }

  [[nodiscard]] double fastest(std::size_t index) const {
    double speed = 1e3;
    for (std::size_t joint = 0; joint < limits_.size(); ++joint) {
      const auto row = static_cast<Eigen::Index>(joint);
      const double along = std::abs(along_[index][row]);
      const double curve = std::abs(curve_[index][row]);
      if (along > 1e-9) speed = std::min(speed, limits_[joint].motion.velocity / along);
      if (curve > 1e-9)
        speed =
            std::min(speed, std::sqrt(kCornering * kPlanned * limits_[joint].motion.acceleration / curve));
    }
    return speed;
  }

  /// Limits the speed at `index` to the highest that can be reached from the speed at the neighbour.
  void limit(std::size_t index, std::size_t neighbour, double length) {
    double acceleration = 1e6;
    const double squared = speeds_[neighbour] * speeds_[neighbour];
    for (std::size_t joint = 0; joint < limits_.size(); ++joint) {
      const auto row = static_cast<Eigen::Index>(joint);
      const double along = std::abs(along_[neighbour][row]);
      const double left =
          kPlanned * limits_[joint].motion.acceleration - std::abs(curve_[neighbour][row]) * squared;
      if (along > 1e-9) acceleration = std::min(acceleration, std::max(left, 0.0) / along);
    }
    speeds_[index] = std::min(speeds_[index], std::sqrt(squared + 2 * length * acceleration));
  }

  std::span<const JointLimits> limits_;
  std::vector<double> speeds_;  ///< rad/s on the path
  std::vector<Point> along_;
  std::vector<Point> curve_;
  std::vector<double> lengths_;
  std::vector<double> times_ = {0};
};

/// Positions at a time, if the acceleration is constant between points. Times must not decrease.
class Passing {
 public:
  Passing(const std::vector<Point>& points, const FastestPass& pass)
      : points_(points), times_(pass.times()), speeds_(pass.speeds()) {}

  Point at(double time) {
    while (next_ + 1 < times_.size() && times_[next_] < time)
      ++next_;
    if (points_.size() < 2 || time >= times_.back()) return points_.back();
    if (time <= 0) return points_.front();
    const double duration = times_[next_] - times_[next_ - 1];
    const double part = (time - times_[next_ - 1]) / duration;
    const double begin = speeds_[next_ - 1];
    const double end = speeds_[next_];
    const double length = part * (begin + part * (end - begin) / 2) / ((begin + end) / 2);
    return points_[next_ - 1] + length * (points_[next_] - points_[next_ - 1]);
  }

 private:
  const std::vector<Point>& points_;
  const std::vector<double>& times_;
  const std::vector<double>& speeds_;
  std::size_t next_ = 1;
};

/// How many set points are averaged, so that the change of any joint's acceleration takes long enough.
std::size_t window(std::span<const JointLimits> limits, double period) {
  double longest = 0;
  for (const JointLimits& joint : limits)
    longest = std::max(longest, 2 * joint.motion.acceleration / joint.motion.jerk);
  return static_cast<std::size_t>(std::ceil(longest / period)) + 1;
}

/// Set points of the pass, `stretch` times as slow: each is the average of `averaged` positions in a row.
std::vector<double> averages(const std::vector<Point>& dense, const FastestPass& pass, double stretch,
                             std::size_t averaged, double period) {
  const std::size_t count =
      static_cast<std::size_t>(std::ceil(pass.times().back() * stretch / period)) + averaged;
  Passing ahead(dense, pass);
  Passing behind(dense, pass);
  // The sum over the window that ends at this set point; before the beginning the arm rests there.
  Point sum = dense.front() * static_cast<double>(averaged);
  const auto time_of = [&](std::size_t index, std::size_t earlier) {
    return (static_cast<double>(index) - static_cast<double>(earlier)) * period / stretch;
  };
  std::vector<double> set_points;
  for (std::size_t index = 0; index < count; ++index) {
    sum += ahead.at(time_of(index, 0)) - behind.at(time_of(index, averaged));
    const Point mean = sum / static_cast<double>(averaged);
    set_points.insert(set_points.end(), mean.begin(), mean.end());
  }
  set_points.insert(set_points.end(), dense.back().begin(), dense.back().end());
  return set_points;
}

/// The factor by which the motion must become slower to keep all limits; at most 1 where it keeps them.
double excess_of(const std::vector<double>& set_points, std::span<const JointLimits> limits, double period) {
  const std::size_t joints = limits.size();
  double excess = 0;
  for (std::size_t joint = 0; joint < joints; ++joint) {
    const MotionLimits& motion = limits[joint].motion;
    std::array<double, 3> now{set_points[joint], 0, 0};  // position, velocity, acceleration
    for (std::size_t at = joint; at < set_points.size() + 3 * joints; at += joints) {
      const double position = at < set_points.size() ? set_points[at] : now[0];
      const double velocity = (position - now[0]) / period;
      const double acceleration = (velocity - now[1]) / period;
      const double jerk = (acceleration - now[2]) / period;
      excess = std::max({excess, std::abs(velocity) / motion.velocity,
                         std::sqrt(std::abs(acceleration) / motion.acceleration),
                         std::sqrt(std::abs(jerk) / motion.jerk)});
      now = {position, velocity, acceleration};
    }
  }
  return excess;
}

}  // namespace

segue::Result<PathTiming> PathTiming::make(const std::vector<std::vector<double>>& points,
                                           std::span<const JointLimits> limits, const Options& options) {
  auto path = checked(points, limits);
  if (!path) return std::move(path.error());
  const std::vector<Point> dense = DensePath(*path, options.corner).take();
  const FastestPass pass(dense, limits);
  const double passed = pass.times().back();
  if (!(passed < kLongest)) return refusal("to follow this path takes more than ten minutes");

  // The excess over the limits after averaging can only be estimated for accelerations that change at once
  // and often, so it is measured.
  PathTiming made(limits.size(), options.period);
  double stretch = 1;
  double excess = 1;
  do {
    stretch *= excess > 1 ? 1.001 * excess : 1;
    made.set_points_ = averages(dense, pass, stretch, window(limits, options.period), options.period);
    excess = excess_of(made.set_points_, limits, options.period);
  } while (excess > 1 + 1e-6);
  return made;
}

double PathTiming::duration() const {
  return period_ * static_cast<double>(last());
}

void PathTiming::at(double time, std::span<double> positions) const {
  const double place = std::clamp(time / period_, 0.0, static_cast<double>(last()));
  const auto before = static_cast<std::size_t>(place);
  const std::size_t after = std::min(before + 1, last());
  const double part = place - static_cast<double>(before);
  for (std::size_t joint = 0; joint < joints_; ++joint) {
    const double from = set_points_[before * joints_ + joint];
    positions[joint] = from + part * (set_points_[after * joints_ + joint] - from);
  }
}

}  // namespace manipulation
