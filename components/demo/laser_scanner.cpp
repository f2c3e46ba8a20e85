// SPDX-License-Identifier: Apache-2.0
#include "types.hpp"

#include <segue/task/component.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace demo {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// A laser scanner in a simulated room.
class LaserScanner final : public Component {
 public:
  LaserScanner()
      : Component({.doc = "Measures distances in a square room with round obstacles",
                   .activity = segue::periodic(std::chrono::milliseconds(50))}) {}

 protected:
  segue::Result<void> on_configure() override {
    if (*beams_ < 2 || *beams_ > 4096) {
      return segue::fail(segue::ErrorCode::InvalidArgument, "beams must be from 2 to 4096");
    }
    scan_.first_angle = -M_PI / 2;
    scan_.step = M_PI / static_cast<double>(*beams_ - 1);
    scan_.ranges.assign(*beams_, *max_range_);
    scan_out_.prime(scan_);
    return {};
  }

  void on_update() override {
    pose_in_.read(pose_);
    double angle = pose_.theta + scan_.first_angle;
    for (double& range : scan_.ranges) {
      range = distance_along(angle);
      angle += scan_.step;
    }
    scan_out_.write(scan_);
  }

 private:
  double distance_along(double angle) const {
    const double dx = std::cos(angle);
    const double dy = std::sin(angle);
    double distance = *max_range_;
    const auto wall = [&](double position, double direction) {
      const double edge = direction > 0 ? *room_ : -*room_;
      if (std::abs(direction) > 1e-9)
        distance = std::min(distance, std::max(0.0, (edge - position) / direction));
    };
    wall(pose_.x, dx);
    wall(pose_.y, dy);
    for (const Obstacle& obstacle : *obstacles_) {
      const double along = (obstacle.x - pose_.x) * dx + (obstacle.y - pose_.y) * dy;
      const double aside = (obstacle.y - pose_.y) * dx - (obstacle.x - pose_.x) * dy;
      const double half = obstacle.radius * obstacle.radius - aside * aside;
      if (along > 0 && half > 0) distance = std::min(distance, std::max(0.0, along - std::sqrt(half)));
    }
    return distance;
  }

  InputPort<Pose> pose_in_{*this, "pose", {.doc = "pose of the scanner"}};
  OutputPort<Scan> scan_out_{*this, "scan", {.doc = "the half circle ahead"}};
  Property<std::uint32_t> beams_{*this, "beams", 37, {.doc = "number of distances in a scan"}};
  Property<double> max_range_{
      *this, "max_range", 8.0, {.live = true, .doc = "m; obstacles farther away are not detected"}};
  Property<double> room_{*this, "room", 5.0, {.doc = "m; the room reaches from -room to room in x and y"}};
  Property<std::vector<Obstacle>> obstacles_{
      *this, "obstacles", {{2.0, 0.5, 0.5}, {-1.5, 2.0, 0.8}}, {.doc = "obstacles in the room"}};
  Pose pose_;
  Scan scan_;
};

}  // namespace demo

SEGUE_COMPONENT(demo::LaserScanner)
