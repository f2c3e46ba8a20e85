// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pose2d.hpp"

#include "../messages/sensors.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

/// For tests only: a vehicle in rooms of boxes, without dynamics.
namespace navigation::test {

struct Box {
  double left, bottom, right, top;
};

class Room {
 public:
  explicit Room(std::vector<Box> boxes) : boxes_(std::move(boxes)) {}

  /// m to the nearest box; 0 inside of one.
  [[nodiscard]] double clearance(Point point) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Box& box : boxes_) {
      const double dx = std::max({box.left - point.x, 0.0, point.x - box.right});
      const double dy = std::max({box.bottom - point.y, 0.0, point.y - box.top});
      nearest = std::min(nearest, std::hypot(dx, dy));
    }
    return nearest;
  }
  [[nodiscard]] double distance_along(Point from, double angle) const {
    const double dx = std::cos(angle);
    const double dy = std::sin(angle);
    double nearest = std::numeric_limits<double>::infinity();
    for (const Box& box : boxes_) {
      double enter = 0;
      double leave = nearest;
      clip(box.left - from.x, box.right - from.x, dx, enter, leave);
      clip(box.bottom - from.y, box.top - from.y, dy, enter, leave);
      if (enter < leave) nearest = enter;
    }
    return nearest;
  }
  [[nodiscard]] messages::LaserScan scan(const Pose2D& sensor, std::size_t beams, double longest) const {
    messages::LaserScan scan;
    scan.first_angle = -M_PI;
    scan.angle_step = 2 * M_PI / static_cast<double>(beams);
    scan.minimum_range = 0.05;
    scan.maximum_range = longest;
    for (std::size_t i = 0; i < beams; ++i) {
      const double angle = sensor.theta + scan.first_angle + static_cast<double>(i) * scan.angle_step;
      const double distance = distance_along({sensor.x, sensor.y}, angle);
      scan.ranges.push_back(distance <= longest ? static_cast<float>(distance)
                                                : std::numeric_limits<float>::infinity());
    }
    return scan;
  }

 private:
  static void clip(double first, double last, double direction, double& enter, double& leave) {
    if (std::abs(direction) < 1e-12) {
      if (first > 0 || last < 0) leave = -1;
      return;
    }
    const double a = first / direction;
    const double b = last / direction;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }

  std::vector<Box> boxes_;
};

/// Two rooms of 4 m by 6 m joined by a door that is 1.1 m wide, with a table and a cupboard.
inline Room two_rooms() {
  return Room({{-0.2, -0.2, 8.2, 0},
               {-0.2, 6, 8.2, 6.2},
               {-0.2, 0, 0, 6},
               {8, 0, 8.2, 6},
               {3.95, 0, 4.05, 3.4},
               {3.95, 4.5, 4.05, 6},
               {1.6, 3.2, 2.4, 3.8},
               {6.2, 1.4, 6.9, 3}});
}

}  // namespace navigation::test
