// SPDX-License-Identifier: Apache-2.0
#include "types.hpp"

#include <segue/task/component.hpp>

#include <algorithm>
#include <chrono>

namespace demo {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// A simulated joystick, moved by its operation: `segue call joystick.push '{forward: 1, turn: 0}'`.
class Joystick final : public Component {
 public:
  Joystick()
      : Component({.doc = "Commands velocities by hand",
                   .activity = segue::periodic(std::chrono::milliseconds(50))}) {}

 protected:
  segue::Result<void> on_start() override {
    stick_ = {};
    return {};
  }
  void on_update() override { command_out_.write({stick_.forward * *speed_, stick_.turn * *turn_}); }

 private:
  void push(double forward, double turn) {
    stick_ = {std::clamp(forward, -1.0, 1.0), std::clamp(turn, -1.0, 1.0)};
  }

  OutputPort<Velocity> command_out_{*this, "command"};
  Property<double> speed_{*this, "speed", 0.5, {.live = true, .doc = "m/s at full deflection"}};
  Property<double> turn_{*this, "turn", 1.0, {.live = true, .doc = "rad/s at full deflection"}};
  Operation<void(double, double)> push_{*this,
                                        "push",
                                        {"forward", "turn"},
                                        [this](double forward, double turn) { push(forward, turn); },
                                        RunsIn::TaskThread,
                                        "moves the stick; both values from -1 to 1"};
  Velocity stick_;
};

}  // namespace demo

SEGUE_COMPONENT(demo::Joystick)
