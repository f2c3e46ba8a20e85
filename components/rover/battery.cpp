// SPDX-License-Identifier: Apache-2.0
#include "types.hpp"

#include "../messages/sensors.hpp"

#include <segue/task/component.hpp>

#include <algorithm>
#include <cmath>

namespace rover {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// The battery of a simulated robot: what its joints do and what is always on take energy from it. It
/// measures time by the robot's clock, that of the joints.
class Battery final : public Component {
 public:
  Battery()
      : Component(
            {.doc = "Tells how much charge is left, by the work of the joints and what is always switched on",
             .trigger_on = {"arm"}}) {}

 protected:
  segue::Result<void> on_configure() override {
    if (!(*capacity_ > 0) || !(*efficiency_ > 0) || *efficiency_ > 1 || !(*idle_power_ >= 0)) {
      return segue::fail(segue::ErrorCode::InvalidArgument,
                         "capacity must be positive, efficiency from 0 to 1, idle_power not negative");
    }
    if (!(*charge_ >= 0) || *charge_ > 1) {
      return segue::fail(segue::ErrorCode::InvalidArgument, "charge must be from 0 to 1");
    }
    energy_ = *charge_ * *capacity_ * kJoulesPerWattHour;
    return {};
  }

  segue::Result<void> on_start() override {
    begun_ = false;
    return {};
  }

  void on_update() override {
    const auto arm = arm_in_.take();
    if (!arm) return;
    if (const auto wheels = wheels_in_.take()) wheel_power_ = power_of(*wheels);
    const double passed = begun_ ? std::max(arm->time - status_.time, 0.0) : 0;
    begun_ = true;
    status_.time = arm->time;
    status_.power = *idle_power_ + (power_of(*arm) + wheel_power_) / *efficiency_;
    energy_ = std::max(energy_ - status_.power * passed, 0.0);
    status_.charge = energy_ / (*capacity_ * kJoulesPerWattHour);
    (energy_ <= 0 ? empty_ : status_.charge < *low_ ? low_state_ : good_).enter();
    status_out_.write(status_);
  }

 private:
  static constexpr double kJoulesPerWattHour = 3600;

  /// Mechanical, W. Joints that are driven from outside give nothing back.
  static double power_of(const messages::JointState& joints) {
    double power = 0;
    for (std::size_t joint = 0; joint < std::min(joints.velocities.size(), joints.efforts.size()); ++joint)
      power += std::max(joints.velocities[joint] * joints.efforts[joint], 0.0);
    return std::isfinite(power) ? power : 0;
  }

  segue::Result<void> recharge(double charge) {
    if (!(charge >= 0) || charge > 1) {
      return segue::fail(segue::ErrorCode::InvalidArgument, "charge must be from 0 to 1");
    }
    energy_ = charge * *capacity_ * kJoulesPerWattHour;
    return {};
  }

  State good_{*this, "good"};
  State low_state_{*this, "low"};
  State empty_{*this, "empty"};
  InputPort<messages::JointState> arm_in_{*this, "arm", {.doc = "the joints of the arm"}};
  InputPort<messages::JointState> wheels_in_{*this, "wheels", {.doc = "the joints of the wheels"}};
  OutputPort<BatteryStatus> status_out_{*this, "status"};
  Property<double> capacity_{*this, "capacity", 50, {.doc = "Wh"}};
  Property<double> charge_{*this, "charge", 1, {.doc = "at the beginning; 1 is full"}};
  Property<double> low_{*this, "low", 0.2, {.live = true, .doc = "the state is low below this charge"}};
  Property<double> idle_power_{
      *this, "idle_power", 15, {.live = true, .doc = "W, of computers and sensors, at rest"}};
  Property<double> efficiency_{*this, "efficiency", 0.7, {.doc = "of the motors"}};
  Operation<segue::Result<void>(double)> recharge_{*this,
                                                   "recharge",
                                                   {"charge"},
                                                   [this](double charge) { return recharge(charge); },
                                                   RunsIn::TaskThread,
                                                   "puts in another battery, charged so far: 1 is full"};
  double energy_ = 0;  ///< J, that is left
  double wheel_power_ = 0;
  bool begun_ = false;
  BatteryStatus status_;
};

}  // namespace rover

SEGUE_COMPONENT(rover::Battery)
