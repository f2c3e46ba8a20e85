// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/describe.hpp>

#include <array>
#include <cstdint>
#include <vector>

/// A simulated rover with six wheels, an arm and cameras. Units and frames: messages/geometry.hpp.
namespace rover {

/// Set points for the wheels: front left, front right, middle left, middle right, rear left, rear right.
struct WheelCommand {
  double time = 0;
  std::array<double, 6> steering{};  ///< rad, counterclockwise from straight ahead
  std::array<double, 6> speeds{};    ///< rad/s, positive: forward
};

struct GripperCommand {
  double time = 0;
  double opening = 0;  ///< m, between the fingers
};

/// Where everything is, robot and boxes: what a renderer in another process needs to draw the scene.
struct SceneState {
  double time = 0;
  std::vector<double> positions;  ///< in the order of the model's joints (mjData::qpos)
};

/// The age of the set points that an update of the simulation used: how many updates ago they arrived, which
/// is 0 where drivers keep up.
struct SetPointAges {
  double time = 0;   ///< s, the robot's clock before the update
  double clock = 0;  ///< s, the computer's clock then
  std::uint32_t wheels = 0;
  std::uint32_t arm = 0;
};

struct BatteryStatus {
  double time = 0;
  double charge = 1;  ///< 1: full, 0: empty
  double power = 0;   ///< W, that is drawn
};

/// A velocity to be commanded for some time.
struct Leg {
  double duration = 0;  ///< s
  double linear = 0;    ///< m/s
  double angular = 0;   ///< rad/s
};

SEGUE_TYPE(WheelCommand, time, steering, speeds)
SEGUE_TYPE(GripperCommand, time, opening)
SEGUE_TYPE(SceneState, time, positions)
SEGUE_TYPE(SetPointAges, time, clock, wheels, arm)
SEGUE_TYPE(BatteryStatus, time, charge, power)
SEGUE_TYPE(Leg, duration, linear, angular)

}  // namespace rover
