// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../rover/rover_model.hpp"
#include "path_search.hpp"
#include "types.hpp"

#include <Eigen/Geometry>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace planning {

inline Eigen::Isometry3d frame_of(const messages::Pose& pose) {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  frame.translate(pose.position);
  frame.rotate(pose.orientation.normalized());
  return frame;
}
inline messages::Pose pose_of(const Eigen::Isometry3d& frame) {
  return {frame.translation(), Eigen::Quaterniond(frame.linear())};
}

/// The contacts that a configuration may have.
struct Tolerance {
  double clearance = 0.01;  ///< m, between what moves and what does not
  std::int32_t box = -1;    ///< this box may touch anything; -1: none
};

/// The rover's arm among the boxes of a situation and what stands in the room, in MuJoCo's model of both, in
/// which here, unlike in the simulation, the arm, its hand and what it holds touch each other and the rest of
/// the rover. Distances are those of MuJoCo's collision functions. One thread at a time.
class ArmScene {
 public:
  /// Unsupported where MuJoCo does not take the model.
  static segue::Result<std::unique_ptr<ArmScene>> create();

  /// Requires a situation that makes sense (plan_request.hpp).
  void set(const Situation& situation);

  /// The lowest and the highest position of each joint, rad.
  [[nodiscard]] static std::vector<std::pair<double, double>> limits();
  /// The pose of the tool in the frame of the rover. This and the functions below require six positions.
  [[nodiscard]] Eigen::Isometry3d tool(const Positions& positions);
  /// A pair that touches, or comes closer than it may: "the arm and the room"; nothing if all is free.
  [[nodiscard]] std::optional<std::string> contact(const Positions& positions, const Tolerance& tolerance);
  /// Positions within the limits in which the tool has that pose, found from `near` by damped least squares
  /// (Buss, "Introduction to inverse kinematics", 2004); nothing where that does not get there.
  [[nodiscard]] std::optional<Positions> reach(const Eigen::Isometry3d& pose, const Positions& near);

 private:
  explicit ArmScene(rover::ModelPtr model);
  enum class Part : std::uint8_t { Room, Rover, Arm, Hand, Box };
  struct Shape {
    Part part = Part::Room;
    int body = 0;
    std::int32_t box = -1;
  };
  void sort_shapes();
  void move_to(const Positions& positions);
  void hold(std::int32_t box);
  void place_box(std::size_t number, const Eigen::Isometry3d& in_rover);
  [[nodiscard]] bool may_touch(const Shape& a, const Shape& b) const;

  rover::ModelPtr model_;
  rover::DataPtr data_;
  std::vector<Shape> shapes_;  ///< of each geom
  std::array<int, rover::kArmJoints> arm_{};
  std::array<int, rover::kBoxes> boxes_{};
  std::array<int, 2> fingers_{};
  int arm_base_ = 0;  ///< body of the first joint
  int tool_ = 0;
  Eigen::Isometry3d base_ = Eigen::Isometry3d::Identity();  ///< of the rover in the room
  Eigen::Isometry3d grasp_ = Eigen::Isometry3d::Identity();
  std::int32_t held_ = -1;
};

}  // namespace planning
