// SPDX-License-Identifier: Apache-2.0
#include "twist_input.hpp"

#include <segue/base/text.hpp>
#include <segue/task/component.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <string_view>

namespace manipulation {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Deals out the velocities of one 3D mouse to a vehicle and the arm on it.
class CommandSplitter final : public Component {
 public:
  CommandSplitter()
      : Component({.doc = "Deals out the velocities of a 3D mouse to a vehicle and its arm",
                   .activity = segue::periodic(std::chrono::milliseconds(20))}) {}

 private:
  enum class Mode : std::uint8_t { Drive, Arm, Both };
  static constexpr std::array<std::string_view, 3> kModes = {"drive", "arm", "both"};

  segue::Result<void> on_configure() override {
    if (!(*drive_gain_ >= 0) || !(*turn_gain_ >= 0) || !(*arm_gain_ >= 0)) {
      return segue::fail(segue::ErrorCode::InvalidArgument,
                         "drive_gain, turn_gain and arm_gain must be numbers that are not negative");
    }
    return control(*mode_property_);
  }

  segue::Result<void> on_start() override {
    twist_in_.begin();
    return {};
  }

  void on_update() override {
    const bool fresh = twist_in_.read(now(), *timeout_);
    (fresh ? *states_.at(static_cast<std::size_t>(mode_)) : waiting_).enter();
    write(fresh ? twist_in_.twist() : messages::Twist{});
  }

  void on_stop() override { write({}); }

  /// A vehicle has two velocities only. Where both are controlled, the arm does not get those that the
  /// vehicle takes.
  void write(const messages::Twist& twist) {
    messages::Twist2D drive;
    messages::Twist arm;
    if (mode_ != Mode::Arm) drive = {*drive_gain_ * twist.linear.x(), *turn_gain_ * twist.angular.z()};
    if (mode_ != Mode::Drive) arm = {*arm_gain_ * twist.linear, *arm_gain_ * twist.angular};
    if (mode_ == Mode::Both) arm.linear.x() = arm.angular.z() = 0;
    drive_out_.write(drive);
    arm_out_.write(arm);
  }

  segue::Result<void> control(const std::string& name) {
    const auto* const found = std::ranges::find(kModes, name);
    if (found == kModes.end()) {
      return segue::fail(segue::ErrorCode::InvalidArgument,
                         "a 3D mouse controls drive, arm or both, not " + segue::quote(name));
    }
    mode_ = static_cast<Mode>(found - kModes.begin());
    return {};
  }

  State waiting_{*this, "waiting"};
  State drive_{*this, "drive"};
  State arm_{*this, "arm"};
  State both_{*this, "both"};
  const std::array<const State*, kModes.size()> states_ = {&drive_, &arm_, &both_};  ///< of each mode
  TwistInput twist_in_{*this, "of the 3D mouse"};
  OutputPort<messages::Twist2D> drive_out_{*this, "drive", {.doc = "for the vehicle"}};
  OutputPort<messages::Twist> arm_out_{
      *this, "arm", {.doc = "for the tip of the arm, in the frame of its base"}};
  Property<std::string> mode_property_{
      *this,
      "mode",
      "both",
      {.doc = "drive, arm, or both: then x and the rotation about z drive, and all else moves the arm"}};
  Property<double> drive_gain_{*this, "drive_gain", 1.0, {.live = true, .doc = "of what the vehicle drives"}};
  Property<double> turn_gain_{*this, "turn_gain", 1.0, {.live = true, .doc = "of what it turns"}};
  Property<double> arm_gain_{*this, "arm_gain", 1.0, {.live = true, .doc = "of what the arm moves"}};
  Property<std::chrono::milliseconds> timeout_{
      *this,
      "timeout",
      std::chrono::milliseconds(200),
      {.live = true, .doc = "commands to stand still where the mouse has been silent for longer"}};
  Operation<segue::Result<void>(std::string)> control_{
      *this,
      "control",
      {"what"},
      [this](const std::string& what) { return control(what); },
      RunsIn::TaskThread,
      "controls drive, arm or both from now on, until it is configured again"};

  Mode mode_ = Mode::Both;
};

}  // namespace manipulation

SEGUE_COMPONENT(manipulation::CommandSplitter)
