// SPDX-License-Identifier: Apache-2.0
#include "drive_control.hpp"
#include "drive_kinematics.hpp"
#include "rover_model.hpp"
#include "types.hpp"

#include "../messages/sensors.hpp"

#include <segue/task/component.hpp>
#include <segue/task/input_timeout.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace rover {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// The driver of the wheels: steers and turns them as a commanded velocity demands, and tells by their
/// movement where the rover is. It measures movements by the robot's clock, and waits for commands by its
/// own.
class RoverDrive final : public Component {
 public:
  RoverDrive()
      : Component(
            {.doc = "Drives six steered wheels at a commanded velocity, within limits, and measures the way",
             .claims = {"wheels"},
             .trigger_on = {"measured"}}) {}

 protected:
  segue::Result<void> on_configure() override {
    if (*max_acceleration_ <= 0 || *max_angular_acceleration_ <= 0) {
      return segue::fail(segue::ErrorCode::InvalidArgument,
                         "max_acceleration and max_angular_acceleration must be positive");
    }
    odometry_ = {};
    return {};
  }

  segue::Result<void> on_start() override {
    first_ = true;
    control_ = DriveControl({*max_acceleration_, *max_angular_acceleration_});
    wanted_ = {};
    return {};
  }

  void on_update() override {
    const auto measured = measured_in_.take();
    if (!measured) return;
    if (measured->positions.size() != 2 * kWheels) {
      exception("measured must tell the positions of six steering joints and six wheels");
      return;
    }
    const double step = first_ ? 0 : measured->time - odometry_.time;
    measure(*measured, step);
    follow(step);
  }

 private:
  void measure(const messages::JointState& measured, double step) {
    PerWheel angles{};
    for (std::size_t wheel = 0; wheel < kWheels; ++wheel) {
      const double position = measured.positions[kWheels + wheel];
      steering_.at(wheel) = measured.positions[wheel];
      angles.at(wheel) = first_ ? 0 : position - positions_.at(wheel);
      positions_.at(wheel) = position;
    }
    first_ = false;
    const messages::Pose2D movement = movement_of(angles, steering_);
    odometry_.time = measured.time;
    odometry_.pose = moved(odometry_.pose, movement);
    if (step > 0) odometry_.twist = {movement.x / step, movement.theta / step};
    odometry_out_.write(odometry_);
  }

  void follow(double step) {
    messages::Twist2D command;
    if (command_in_.read(command) == ReadStatus::NewData) accept(command);
    // Whoever commanded until a switch cannot tell it to stop any more.
    if (!command_in_.connected() || timeout_.passed()) wanted_ = {};
    WheelCommand set_points = control_.advance(wanted_, steering_, step);
    set_points.time = odometry_.time;
    wheels_out_.write(set_points);
    const bool standing = control_.twist().linear == 0 && control_.twist().angular == 0;
    (standing && wanted_.linear == 0 && wanted_.angular == 0 ? idle_ : driving_).enter();
  }

  /// A command that is not a number may mean anything, so the rover stops.
  void accept(const messages::Twist2D& command) {
    const bool is_velocity = std::isfinite(command.linear) && std::isfinite(command.angular);
    wanted_ = is_velocity ? messages::Twist2D{std::clamp(command.linear, -*max_speed_, *max_speed_),
                                              std::clamp(command.angular, -*max_turn_, *max_turn_)}
                          : messages::Twist2D{};
  }

  State driving_{*this, "driving"};
  State idle_{*this, "idle"};
  InputPort<messages::Twist2D> command_in_{*this, "command", {.doc = "wanted velocity"}};
  InputPort<messages::JointState> measured_in_{
      *this, "measured", {.doc = "state of six steering joints and six wheels"}};
  OutputPort<WheelCommand> wheels_out_{*this, "wheels", {.doc = "set points of the wheels"}};
  OutputPort<messages::Odometry> odometry_out_{
      *this, "odometry", {.doc = "by the wheels; starts at zero with configure"}};
  Property<double> max_speed_{*this, "max_speed", 0.5, {.live = true, .doc = "m/s"}};
  Property<double> max_turn_{*this, "max_turn", 1.0, {.live = true, .doc = "rad/s"}};
  Property<double> max_acceleration_{*this, "max_acceleration", 1.0, {.doc = "m/s^2"}};
  Property<double> max_angular_acceleration_{*this, "max_angular_acceleration", 3.0, {.doc = "rad/s^2"}};
  InputTimeout timeout_{command_in_, "timeout", std::chrono::milliseconds(500),
                        "stops after this time without a command, and at once where nobody is connected"};
  bool first_ = true;
  PerWheel steering_{};
  PerWheel positions_{};
  messages::Twist2D wanted_;
  DriveControl control_;
  messages::Odometry odometry_;
};

}  // namespace rover

SEGUE_COMPONENT(rover::RoverDrive)
