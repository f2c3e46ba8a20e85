// SPDX-License-Identifier: Apache-2.0
#include "types.hpp"

#include <segue/task/component.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace demo {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Passes commands on, but stops forward motion in front of obstacles.
class ObstacleStop final : public Component {
 public:
  ObstacleStop()
      : Component({.doc = "Passes velocity commands on, without forward motion when something is close ahead",
                   .trigger_on = {"command"}}) {}

 protected:
  segue::Result<void> on_start() override {
    ahead_ = 0;  // blocked until the first scan
    return {};
  }

  void on_update() override {
    while (auto scan = scan_in_.take()) {
      ahead_ = nearest_ahead(*scan);
    }
    const bool blocked = ahead_ < *distance_;
    (blocked ? blocked_ : clear_).enter();
    while (auto command = command_in_.take()) {
      Velocity safe = *command;
      safe.forward = blocked ? std::min(safe.forward, 0.0) : safe.forward;
      command_out_.write(safe);
    }
  }

 private:
  double nearest_ahead(const Scan& scan) const {
    double nearest = HUGE_VAL;
    double angle = scan.first_angle;
    for (const double range : scan.ranges) {
      if (std::abs(angle) <= *half_angle_) nearest = std::min(nearest, range);
      angle += scan.step;
    }
    return nearest;
  }

  State clear_{*this, "clear"};
  State blocked_{*this, "blocked"};
  InputPort<Scan> scan_in_{*this, "scan"};
  InputPort<Velocity> command_in_{*this, "command", {.doc = "what is wanted"}};
  OutputPort<Velocity> command_out_{*this, "safe_command", {.doc = "the command, limited to what is safe"}};
  Property<double> distance_{
      *this, "distance", 0.4, {.live = true, .doc = "m; obstacles closer than this block the way"}};
  Property<double> half_angle_{
      *this, "half_angle", 0.6, {.live = true, .doc = "rad; angle to either side that counts as ahead"}};
  double ahead_ = 0;
};

}  // namespace demo

SEGUE_COMPONENT(demo::ObstacleStop)
