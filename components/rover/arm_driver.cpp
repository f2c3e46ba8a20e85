// SPDX-License-Identifier: Apache-2.0
#include "rover_model.hpp"

#include "../messages/sensors.hpp"

#include <segue/task/component.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <vector>

namespace rover {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// The driver of the arm: moves its joints to commanded positions, no faster than allowed, and holds them.
class ArmDriver final : public Component {
 public:
  ArmDriver()
      : Component(
            {.doc = "Moves six joints to commanded positions, within their limits, and holds them there",
             .claims = {"arm"},
             .trigger_on = {"measured"}}) {}

 protected:
  segue::Result<void> on_configure() override {
    if (*max_velocity_ <= 0) {
      return segue::fail(segue::ErrorCode::InvalidArgument, "max_velocity must be positive");
    }
    messages::JointState joints;
    joints.positions.resize(kArmJoints);
    joints.velocities.resize(kArmJoints);
    joints.efforts.resize(kArmJoints);
    joints_out_.prime(joints);
    set_points_.positions.resize(kArmJoints);
    set_points_out_.prime(set_points_);
    return {};
  }

  segue::Result<void> on_start() override {
    first_ = true;
    told_ = false;
    return {};
  }

  void on_update() override {
    const auto measured = measured_in_.take();
    if (!measured) return;
    if (measured->positions.size() != kArmJoints) {
      exception("measured must tell the positions of six joints");
      return;
    }
    if (first_) begin(*measured);
    if (const auto command = command_in_.take()) follow(*command);
    advance(measured->time - set_points_.time);
    set_points_.time = measured->time;
    (arrived(*measured) ? holding_ : moving_).enter();
    set_points_out_.write(set_points_);
    joints_out_.write(*measured);
  }

 private:
  using Positions = std::array<double, kArmJoints>;

  void begin(const messages::JointState& measured) {
    first_ = false;
    set_points_.time = measured.time;
    std::copy(measured.positions.begin(), measured.positions.end(), set_points_.positions.begin());
    if (!told_) std::copy(measured.positions.begin(), measured.positions.end(), target_.begin());
  }

  /// Commands that are not for six joints, or are not numbers, are none.
  void follow(const messages::JointCommand& command) {
    const auto& positions = command.positions;
    const auto finite = [](double position) { return std::isfinite(position); };
    if (positions.size() != kArmJoints || !std::all_of(positions.begin(), positions.end(), finite)) return;
    for (std::size_t joint = 0; joint < kArmJoints; ++joint)
      target_.at(joint) = std::clamp(positions[joint], kArm.at(joint).lowest, kArm.at(joint).highest);
  }

  void advance(double step) {
    const double most = *max_velocity_ * std::max(step, 0.0);
    for (std::size_t joint = 0; joint < kArmJoints; ++joint)
      set_points_.positions[joint] +=
          std::clamp(target_.at(joint) - set_points_.positions[joint], -most, most);
  }

  [[nodiscard]] bool arrived(const messages::JointState& measured) const {
    constexpr double kStill = 0.02;  // rad/s
    const auto moves = [](double velocity) { return std::abs(velocity) > kStill; };
    for (std::size_t joint = 0; joint < kArmJoints; ++joint) {
      if (std::abs(target_.at(joint) - measured.positions[joint]) > *tolerance_) return false;
    }
    return !std::any_of(measured.velocities.begin(), measured.velocities.end(), moves);
  }

  static std::string rounded(double number) {
    std::array<char, 32> text{};
    return {text.data(),
            std::to_chars(text.data(), text.data() + text.size(), number, std::chars_format::general, 4).ptr};
  }

  segue::Result<void> move_to(const std::vector<double>& positions) {
    if (positions.size() != kArmJoints) {
      return segue::fail(segue::ErrorCode::InvalidArgument,
                         "the arm has 6 joints, not " + std::to_string(positions.size()));
    }
    for (std::size_t joint = 0; joint < kArmJoints; ++joint) {
      const ArmJoint& limits = kArm.at(joint);
      if (positions[joint] >= limits.lowest && positions[joint] <= limits.highest) continue;
      return segue::fail(segue::ErrorCode::InvalidArgument,
                         "joint " + std::to_string(joint + 1) + " reaches from " + rounded(limits.lowest) +
                             " to " + rounded(limits.highest) + " rad, not to " + rounded(positions[joint]));
    }
    std::copy(positions.begin(), positions.end(), target_.begin());
    told_ = true;
    moving_.enter();
    return {};
  }

  State moving_{*this, "moving"};
  State holding_{*this, "holding"};
  InputPort<messages::JointCommand> command_in_{
      *this, "command", {.doc = "wanted positions; those beyond limits count as the limits"}};
  InputPort<messages::JointState> measured_in_{*this, "measured", {.doc = "state of the joints"}};
  OutputPort<messages::JointCommand> set_points_out_{*this, "set_points", {.doc = "for the joints' servos"}};
  OutputPort<messages::JointState> joints_out_{*this, "joints", {.doc = "state of the joints"}};
  Property<double> max_velocity_{*this, "max_velocity", 1.0, {.live = true, .doc = "rad/s, of each joint"}};
  Property<double> tolerance_{
      *this,
      "tolerance",
      0.02,
      {.live = true, .doc = "rad; nearer joints are where they are wanted, once they stand still"}};
  Operation<segue::Result<void>(std::vector<double>)> move_to_{
      *this,
      "move_to",
      {"positions"},
      [this](const std::vector<double>& positions) { return move_to(positions); },
      RunsIn::TaskThread,
      "moves to these positions (rad); the state is holding when it is there"};
  Operation<segue::Result<void>()> stow_{*this,
                                         "stow",
                                         {},
                                         [this] {
                                           return move_to({kArmHome.begin(), kArmHome.end()});
                                         },
                                         RunsIn::TaskThread,
                                         "folds the arm, as it is at the beginning"};
  bool first_ = true;
  bool told_ = false;  ///< by an operation, since the start
  Positions target_{};
  messages::JointCommand set_points_;
};

}  // namespace rover

SEGUE_COMPONENT(rover::ArmDriver)
