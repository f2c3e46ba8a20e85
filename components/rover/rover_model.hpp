// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <mujoco/mujoco.h>
#include <array>
#include <memory>
#include <string>

/// The rover and its room as a MuJoCo model: what it measures, in metres and radians, and how it is loaded.
/// All simulations and all cameras use the same model, so that the positions of its joints are all that they
/// have to tell each other.
///
/// Frames: that of the rover lies on the ground between the middle wheels, x forward, z upward. The rover
/// does not collide with itself.
namespace rover {

struct WheelPlace {
  const char* name;
  double x;
  double y;
};
inline constexpr std::size_t kWheels = 6;
inline constexpr std::array<WheelPlace, kWheels> kWheelPlaces = {{{"front_left", 0.32, 0.30},
                                                                  {"front_right", 0.32, -0.30},
                                                                  {"middle_left", 0.0, 0.30},
                                                                  {"middle_right", 0.0, -0.30},
                                                                  {"rear_left", -0.32, 0.30},
                                                                  {"rear_right", -0.32, -0.30}}};
inline constexpr double kWheelRadius = 0.10;
inline constexpr double kLargestSteering =
    1.6;  ///< more than a quarter turn, so that a wheel can move in every direction

/// A joint of the arm: its place in the frame of the joint before it (the first one: in that of the rover)
/// and its axis. With all angles zero, all frames are parallel and the arm is stretched forward.
struct ArmJoint {
  std::array<double, 3> place;
  std::array<double, 3> axis;
  double lowest;
  double highest;
  double largest_torque;  ///< N m
};
inline constexpr std::size_t kArmJoints = 6;
inline constexpr std::array<ArmJoint, kArmJoints> kArm = {{{{0.25, 0, 0.33}, {0, 0, 1}, -2.9, 2.9, 80},
                                                           {{0, 0, 0.10}, {0, 1, 0}, -2.4, 1.0, 120},
                                                           {{0.32, 0, 0}, {0, 1, 0}, -0.3, 2.8, 80},
                                                           {{0.10, 0, 0}, {1, 0, 0}, -2.9, 2.9, 30},
                                                           {{0.20, 0, 0}, {0, 1, 0}, -2.0, 2.0, 30},
                                                           {{0.06, 0, 0}, {1, 0, 0}, -2.9, 2.9, 20}}};
/// The point between the finger tips, in the frame of the last joint; x points along the fingers, which open
/// along y.
inline constexpr std::array<double, 3> kTool = {0.14, 0, 0};
/// Folded, the hand before the deck, where it does not hide the table from the mast.
inline constexpr std::array<double, kArmJoints> kArmHome = {0, -1.9, 2.5, 0, 0.6, 0};

inline constexpr double kDeckHeight = 0.31;      ///< of its upper side, which is flat behind the arm
inline constexpr double kLargestOpening = 0.09;  ///< between the fingers
inline constexpr double kGripForce = 10;         ///< N, of each finger

/// Cubes with the AprilTag of their number (family 36h11) on every side.
inline constexpr std::size_t kBoxes = 3;
inline constexpr double kBoxSide = 0.06;
inline constexpr double kMarkerSide = 0.8 * kBoxSide;  ///< of the black border, as detectors want it
/// Where boxes lie on the deck of a rover that has been loaded, in its frame.
struct DeckPlace {
  double x;
  double y;
};
inline constexpr std::array<DeckPlace, kBoxes> kDeckPlaces = {
    {{0.05, -0.27}, {-0.10, -0.27}, {-0.02, -0.12}}};
/// The cameras "mast", "deck" and "gripper": the height of the image in radians.
inline constexpr double kFieldOfView = 0.7854;
/// The largest image that a camera may deliver.
inline constexpr int kLargestWidth = 640;
inline constexpr int kLargestHeight = 480;

/// The room is square; the rover starts in its centre and faces the table.
inline constexpr double kWallDistance = 3.0;  ///< from the centre to the inner sides of the walls
inline constexpr double kTableHeight = 0.30;
inline constexpr double kTableEdge = 1.50;                             ///< x of its front
inline constexpr std::array<double, 3> kLidarPlace = {0.40, 0, 0.24};  ///< in the frame of the rover

struct DeleteModel {
  void operator()(mjModel* model) const noexcept { mj_deleteModel(model); }
};
struct DeleteData {
  void operator()(mjData* data) const noexcept { mj_deleteData(data); }
};
using ModelPtr = std::unique_ptr<mjModel, DeleteModel>;
using DataPtr = std::unique_ptr<mjData, DeleteData>;

/// The model as MJCF.
std::string rover_model_text();

/// Loads the model, with the textures of the markers. Unsupported with MuJoCo's message if it does not take
/// it. Any thread; takes some 10 ms.
segue::Result<ModelPtr> load_rover_model();

}  // namespace rover
