// SPDX-License-Identifier: Apache-2.0
#include "types.hpp"

#include <segue/task/component.hpp>
#include <segue/task/input_timeout.hpp>

#include <algorithm>
#include <chrono>

namespace demo {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// The drive: follows a commanded velocity within its limits, and stops when no command arrives for too long.
class Drive final : public Component {
 public:
  Drive()
      : Component({.doc = "Follows commanded velocities within limits of speed and acceleration",
                   .activity = segue::periodic(std::chrono::milliseconds(20)),
                   .claims = {"wheels"}}) {}

 protected:
  segue::Result<void> on_configure() override {
    if (*max_acceleration_ <= 0) {
      return segue::fail(segue::ErrorCode::InvalidArgument, "max_acceleration must be positive");
    }
    return {};
  }

  segue::Result<void> on_start() override {
    velocity_ = {};
    last_ = now();
    return {};
  }

  void on_update() override {
    const double step = std::chrono::duration<double>(now() - last_).count();
    last_ = now();
    command_in_.read(command_);
    // Whoever commanded until a switch cannot tell it to stop any more.
    const bool late = !command_in_.connected() || timeout_.passed();
    const Velocity wanted = late ? Velocity{} : command_;
    const double change = *max_acceleration_ * step;
    const double forward = std::clamp(wanted.forward, -*max_speed_, *max_speed_);
    velocity_.forward += std::clamp(forward - velocity_.forward, -change, change);
    velocity_.turn = std::clamp(wanted.turn, -*max_turn_, *max_turn_);
    const bool stands = velocity_.forward == 0 && velocity_.turn == 0;
    (late && stands ? idle_ : driving_).enter();
    velocity_out_.write(velocity_);
  }

  void on_stop() override { velocity_out_.write({}); }

 private:
  State driving_{*this, "driving"};
  State idle_{*this, "idle"};
  InputPort<Velocity> command_in_{*this, "command", {.doc = "what is wanted"}};
  OutputPort<Velocity> velocity_out_{*this, "velocity", {.doc = "actual velocity"}};
  Property<double> max_speed_{*this, "max_speed", 0.8, {.live = true, .doc = "m/s"}};
  Property<double> max_turn_{*this, "max_turn", 1.5, {.live = true, .doc = "rad/s"}};
  Property<double> max_acceleration_{*this, "max_acceleration", 2.0, {.doc = "m/s^2"}};
  InputTimeout timeout_{command_in_, "timeout", std::chrono::milliseconds(500),
                        "stops after this time without a command, and at once where nobody is connected"};
  Velocity command_;
  Velocity velocity_;
  segue::TimePoint last_;
};

}  // namespace demo

SEGUE_COMPONENT(demo::Drive)
