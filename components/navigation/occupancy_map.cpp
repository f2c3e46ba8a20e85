// SPDX-License-Identifier: Apache-2.0
#include "occupancy_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace navigation {
namespace {

constexpr std::int16_t kUnknown = std::numeric_limits<std::int16_t>::min();
constexpr double kHundredths = 100;

int hundredths(double log_odds) {
  return static_cast<int>(std::lround(kHundredths * std::clamp(log_odds, -300.0, 300.0)));
}

}  // namespace

OccupancyMap::OccupancyMap(const GridFrame& frame, const SensorModel& model)
    : frame_(frame),
      hit_(hundredths(model.hit)),
      miss_(hundredths(model.miss)),
      maximum_(std::abs(hundredths(model.maximum))),
      longest_beam_(model.longest_beam),
      log_odds_(frame.size(), kUnknown),
      scan_of_(frame.size(), 0) {
  for (int odds = -maximum_; odds <= maximum_; ++odds) {
    const double probability = 1 / (1 + std::exp(-odds / kHundredths));
    percent_.push_back(static_cast<std::int8_t>(std::lround(100 * probability)));
  }
}

void OccupancyMap::clear() {
  std::ranges::fill(log_odds_, kUnknown);
}

template <class Visit>
void OccupancyMap::for_each_beam(const messages::LaserScan& scan, const Pose2D& sensor, Visit visit) const {
  const double longest = std::min(longest_beam_, scan.maximum_range);
  double angle = sensor.theta + scan.first_angle;
  for (const float range : scan.ranges) {
    if (range >= scan.minimum_range) {  // false for what is not a number
      const double length = std::min<double>(range, longest);
      visit(Point{sensor.x + length * std::cos(angle), sensor.y + length * std::sin(angle)},
            range <= longest);
    }
    angle += scan.angle_step;
  }
}

void OccupancyMap::add(Cell cell, int change) {
  if (!frame_.contains(cell)) return;
  const std::size_t index = frame_.index(cell);
  if (scan_of_[index] == scan_) return;
  scan_of_[index] = scan_;
  const int before = log_odds_[index] == kUnknown ? 0 : log_odds_[index];
  log_odds_[index] = static_cast<std::int16_t>(std::clamp(before + change, -maximum_, maximum_));
}

void OccupancyMap::integrate(const messages::LaserScan& scan, const Pose2D& sensor) {
  if (!is_finite(sensor)) return;
  if (++scan_ == 0) {  // after four thousand million scans the numbers begin anew
    std::ranges::fill(scan_of_, 0);
    scan_ = 1;
  }
  for_each_beam(scan, sensor, [this](Point end, bool met) {
    if (met) add(frame_.cell_of(end), hit_);
  });
  for_each_beam(scan, sensor, [&](Point end, bool /*met*/) {
    traverse(frame_, {sensor.x, sensor.y}, end, [this](Cell cell, double /*length*/) {
      add(cell, miss_);
      return true;
    });
  });
}

std::int8_t OccupancyMap::occupancy(Cell cell) const {
  if (!frame_.contains(cell)) return -1;
  const std::int16_t odds = log_odds_[frame_.index(cell)];
  return odds == kUnknown ? std::int8_t{-1}
                          : percent_[static_cast<std::size_t>(odds) + static_cast<std::size_t>(maximum_)];
}

void OccupancyMap::write_to(messages::OccupancyGrid& grid) const {
  grid.resolution = frame_.resolution;
  grid.x = frame_.x;
  grid.y = frame_.y;
  grid.width = static_cast<std::uint32_t>(frame_.width);
  grid.height = static_cast<std::uint32_t>(frame_.height);
  grid.cells.resize(log_odds_.size());
  std::ranges::transform(log_odds_, grid.cells.begin(), [this](std::int16_t odds) {
    return odds == kUnknown ? std::int8_t{-1}
                            : percent_[static_cast<std::size_t>(odds) + static_cast<std::size_t>(maximum_)];
  });
}

}  // namespace navigation
