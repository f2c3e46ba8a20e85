// SPDX-License-Identifier: Apache-2.0
#include "rover_model.hpp"
#include "types.hpp"

#include "../messages/sensors.hpp"

#include <segue/task/component.hpp>

#include <cmath>

namespace rover {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// The driver of the gripper. The last set point stays in force while the task is stopped: a box is not
/// dropped by a switch.
class Gripper final : public Component {
 public:
  Gripper()
      : Component({.doc = "Opens and closes the gripper, and tells whether it holds something",
                   .claims = {"gripper"},
                   .trigger_on = {"measured"}}) {}

 protected:
  segue::Result<void> on_start() override {
    commanded_ = false;
    return {};
  }

  void on_update() override {
    const auto measured = measured_in_.take();
    if (!measured) return;
    if (measured->positions.empty() || measured->velocities.empty() || measured->efforts.empty()) {
      exception("measured must tell the opening, its velocity and the force");
      return;
    }
    state_of(measured->positions[0], measured->velocities[0], measured->efforts[0]).enter();
    command_.time = measured->time;
    if (commanded_) command_out_.write(command_);
  }

 private:
  [[nodiscard]] const State& state_of(double opening, double velocity, double force) const {
    constexpr double kStill = 0.01;    // m/s
    constexpr double kClosed = 0.004;  // m
    if (std::abs(velocity) > kStill) return velocity > 0 ? opening_ : closing_;
    if (opening < kClosed) return closed_;
    return force < -0.8 * kGripForce ? holding_ : open_;
  }

  void command(double opening, const State& state) {
    command_.opening = opening;
    commanded_ = true;
    state.enter();
  }

  State opening_{*this, "opening"};
  State closing_{*this, "closing"};
  State open_{*this, "open"};
  State closed_{*this, "closed"};
  State holding_{*this, "holding"};
  InputPort<messages::JointState> measured_in_{
      *this, "measured", {.doc = "opening, its velocity, and the force"}};
  OutputPort<GripperCommand> command_out_{*this, "command", {.doc = "set point for the servo"}};
  Operation<void()> do_open_{*this,
                             "open",
                             {},
                             [this] { command(kLargestOpening, opening_); },
                             RunsIn::TaskThread,
                             "opens the gripper; the state is open then"};
  Operation<void()> do_close_{*this,
                              "close",
                              {},
                              [this] { command(0, closing_); },
                              RunsIn::TaskThread,
                              "closes the gripper; the state is closed or holding then"};
  bool commanded_ = false;
  GripperCommand command_;
};

}  // namespace rover

SEGUE_COMPONENT(rover::Gripper)
