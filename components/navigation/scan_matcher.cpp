// SPDX-License-Identifier: Apache-2.0
#include "scan_matcher.hpp"

#include <algorithm>
#include <cmath>

namespace navigation {
namespace {

constexpr double kCoarseStep = 0.05;   // m
constexpr double kCoarseTurn = 0.025;  // rad
constexpr int kMostCoarseSteps = 40;   // to either side, whatever the window
constexpr std::size_t kFewestPoints = 10;

int steps_in(double window, double step) {
  return static_cast<int>(std::clamp(std::ceil(window / step), 0.0, double{kMostCoarseSteps}));
}

/// How well a beam fits that ends at this distance from what is occupied.
double fit(double distance, double sharpness) {
  const double relative = distance / sharpness;
  return 1 / (1 + relative * relative);
}

double penalty(const Pose2D& pose, const Pose2D& guess, const MatchSettings& settings) {
  const double way = std::hypot(pose.x - guess.x, pose.y - guess.y) / std::max(1e-6, settings.window);
  const double turn = wrapped(pose.theta - guess.theta) / std::max(1e-6, settings.angle_window);
  return settings.guess_weight * (way * way + turn * turn);
}

}  // namespace

ScanMatcher::ScanMatcher(std::size_t most_points) : points_(most_points), turned_(most_points) {}

void ScanMatcher::take(const messages::LaserScan& scan, double longest) {
  count_ = 0;
  const std::size_t stride = scan.ranges.size() / (points_.size() + 1) + 1;
  for (std::size_t i = 0; i < scan.ranges.size() && count_ < points_.size(); i += stride) {
    const double range = scan.ranges[i];
    if (!(range >= scan.minimum_range && range <= std::min(longest, scan.maximum_range))) continue;
    const double angle = scan.first_angle + static_cast<double>(i) * scan.angle_step;
    points_[count_++] = {range * std::cos(angle), range * std::sin(angle)};
  }
}

void ScanMatcher::turn(double theta) {
  const double c = std::cos(theta);
  const double s = std::sin(theta);
  for (std::size_t i = 0; i < count_; ++i)
    turned_[i] = {c * points_[i].x - s * points_[i].y, s * points_[i].x + c * points_[i].y};
}

double ScanMatcher::coarse_score(const ClearanceMap& map, Point place, double sharpness) const {
  const GridFrame& frame = map.frame();
  double sum = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const Cell cell = frame.cell_of({place.x + turned_[i].x, place.y + turned_[i].y});
    if (frame.contains(cell)) sum += fit(map.clearance(frame.index(cell)), sharpness);
  }
  return sum / static_cast<double>(count_);
}

double ScanMatcher::fine_score(const ClearanceMap& map, Point place, double sharpness) const {
  double sum = 0;
  for (std::size_t i = 0; i < count_; ++i)
    sum += fit(map.clearance_at({place.x + turned_[i].x, place.y + turned_[i].y}), sharpness);
  return sum / static_cast<double>(count_);
}

/// The best of all poses in the window, coarsely.
Pose2D ScanMatcher::search(const ClearanceMap& map, const Pose2D& guess, const MatchSettings& settings) {
  const int turns = steps_in(settings.angle_window, kCoarseTurn);
  const int ways = steps_in(settings.window, kCoarseStep);
  Pose2D best = guess;
  double best_score = -1e9;
  for (int k = -turns; k <= turns; ++k) {
    const double theta = guess.theta + k * kCoarseTurn;
    turn(theta);
    for (int i = -ways; i <= ways; ++i) {
      for (int j = -ways; j <= ways; ++j) {
        const Pose2D pose{guess.x + i * kCoarseStep, guess.y + j * kCoarseStep, theta};
        const double score =
            coarse_score(map, {pose.x, pose.y}, settings.sharpness) - penalty(pose, guess, settings);
        if (score <= best_score) continue;
        best_score = score;
        best = pose;
      }
    }
  }
  return best;
}

/// Moves to the best neighbour as long as there is a better one, with ever smaller steps.
Match ScanMatcher::refine(const ClearanceMap& map, const Pose2D& guess, Pose2D pose,
                          const MatchSettings& settings) {
  constexpr int kLevels = 6;
  constexpr int kMostMoves = 6;
  const auto score_of = [&](const Pose2D& candidate) {
    turn(candidate.theta);
    return fine_score(map, {candidate.x, candidate.y}, settings.sharpness) -
           penalty(candidate, guess, settings);
  };
  double best = score_of(pose);
  double step = 0.5;
  for (int level = 0; level < kLevels; ++level, step /= 2) {
    for (int moves = 0; moves < kMostMoves; ++moves) {
      const Pose2D middle = pose;
      const double before = best;
      for (int neighbour = 0; neighbour < 27; ++neighbour) {
        const int along = neighbour % 3 - 1;
        const int across = neighbour / 3 % 3 - 1;
        const int turned = neighbour / 9 - 1;
        const Pose2D candidate{middle.x + step * kCoarseStep * along, middle.y + step * kCoarseStep * across,
                               middle.theta + step * kCoarseTurn * turned};
        const double score = score_of(candidate);
        if (score <= best) continue;
        best = score;
        pose = candidate;
      }
      if (best == before) break;
    }
  }
  pose.theta = wrapped(pose.theta);
  return {pose, best + penalty(pose, guess, settings)};
}

std::optional<Match> ScanMatcher::match(const ClearanceMap& map, const messages::LaserScan& scan,
                                        const Pose2D& guess, const MatchSettings& settings) {
  if (!is_finite(guess)) return std::nullopt;
  take(scan, settings.longest_beam);
  if (count_ < kFewestPoints) return std::nullopt;
  return refine(map, guess, search(map, guess, settings), settings);
}

}  // namespace navigation
