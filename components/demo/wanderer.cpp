// SPDX-License-Identifier: Apache-2.0
#include "types.hpp"

#include <segue/task/component.hpp>

#include <algorithm>
#include <cmath>

namespace demo {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Explores: drives ahead while the way is free, else turns to the freer side.
class Wanderer final : public Component {
 public:
  Wanderer()
      : Component({.doc = "Explores: drives on while the way is free, else turns to the freer side"}) {}

 protected:
  void on_update() override {
    while (auto scan = scan_in_.take()) {
      command_out_.write(decide(*scan));
    }
  }

 private:
  Velocity decide(const Scan& scan) {
    double ahead = HUGE_VAL;
    double right = 0;
    double left = 0;
    double angle = scan.first_angle;
    for (const double range : scan.ranges) {
      if (std::abs(angle) < 0.6) ahead = std::min(ahead, range);
      (angle < 0 ? right : left) += range;
      angle += scan.step;
    }
    if (ahead > *clearance_) {
      cruising_.enter();
      return {*speed_, 0.0};
    }
    turning_.enter();
    return {0.0, left >= right ? *turn_ : -*turn_};
  }

  State cruising_{*this, "cruising"};
  State turning_{*this, "turning"};
  InputPort<Scan> scan_in_{*this, "scan"};
  OutputPort<Velocity> command_out_{*this, "command"};
  Property<double> speed_{*this, "speed", 0.5, {.live = true, .doc = "m/s while the way is free"}};
  Property<double> turn_{*this, "turn", 1.0, {.live = true, .doc = "rad/s while it is blocked"}};
  Property<double> clearance_{
      *this, "clearance", 1.0, {.live = true, .doc = "m; the way is free if there is more than this ahead"}};
};

}  // namespace demo

SEGUE_COMPONENT(demo::Wanderer)
