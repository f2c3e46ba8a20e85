// SPDX-License-Identifier: Apache-2.0
#include "arm_scene.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace planning {
namespace {

constexpr double kMargin = 0.02;  // m; contacts that are farther apart are not looked at
constexpr double kSelfClearance = 0.005;

/// The vector of one of MuJoCo's objects, where those of all follow each other.
Eigen::Vector3d vector_of(const mjtNum* vectors, std::ptrdiff_t object) {
  return Eigen::Map<const Eigen::Vector3d>(vectors + 3 * object);
}

Eigen::Matrix3d matrix_of(const mjtNum* matrices, std::ptrdiff_t object) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(matrices + 9 * object);
}

}  // namespace

segue::Result<std::unique_ptr<ArmScene>> ArmScene::create() {
  auto model = rover::load_rover_model();
  if (!model) return std::move(model.error());
  // Drops MuJoCo's warnings, as the simulation does: its own handler would write a file.
  mju_user_warning = [](const char*) {};
  return std::unique_ptr<ArmScene>(new ArmScene(std::move(*model)));
}

ArmScene::ArmScene(rover::ModelPtr model) : model_(std::move(model)), data_(mj_makeData(model_.get())) {
  const auto joint = [this](const std::string& name) {
    return model_->jnt_qposadr[mj_name2id(model_.get(), mjOBJ_JOINT, name.c_str())];
  };
  for (std::size_t index = 0; index < arm_.size(); ++index)
    arm_.at(index) = mj_name2id(model_.get(), mjOBJ_JOINT, ("arm_" + std::to_string(index + 1)).c_str());
  for (std::size_t number = 0; number < boxes_.size(); ++number)
    boxes_.at(number) = joint("box_" + std::to_string(number));
  fingers_ = {joint("left_finger"), joint("right_finger")};
  tool_ = mj_name2id(model_.get(), mjOBJ_SITE, "tool");
  arm_base_ = model_->jnt_bodyid[arm_[0]];
  sort_shapes();
}

/// Which part of the scene each geom belongs to, and which of them MuJoCo compares: those that move with all.
void ArmScene::sort_shapes() {
  shapes_.resize(static_cast<std::size_t>(model_->ngeom));
  for (int geom = 0; geom < model_->ngeom; ++geom) {
    Shape& shape = shapes_[static_cast<std::size_t>(geom)];
    shape.body = model_->geom_bodyid[geom];
    const std::string name = mj_id2name(model_.get(), mjOBJ_BODY, shape.body) == nullptr
                                 ? std::string()
                                 : mj_id2name(model_.get(), mjOBJ_BODY, shape.body);
    if (shape.body == 0) {
      shape.part = Part::Room;
    } else if (name.starts_with("box_")) {
      shape.part = Part::Box;
      shape.box = std::stoi(name.substr(4));
    } else if (name.ends_with("_finger") || name == "arm_6") {
      shape.part = Part::Hand;
    } else if (name.starts_with("arm_") && shape.body != arm_base_) {
      shape.part = Part::Arm;
    } else {
      shape.part = Part::Rover;
    }
    const bool moves = shape.part == Part::Arm || shape.part == Part::Hand;
    model_->geom_contype[geom] = moves ? 1 : 0;
    model_->geom_conaffinity[geom] = 1;
    model_->geom_margin[geom] = moves ? kMargin : 0;
  }
}

void ArmScene::set(const Situation& situation) {
  mju_copy(data_->qpos, model_->qpos0, model_->nq);
  base_ = Eigen::Isometry3d::Identity();
  base_.translate(Eigen::Vector3d(situation.base.x, situation.base.y, 0));
  base_.rotate(Eigen::AngleAxisd(situation.base.theta, Eigen::Vector3d::UnitZ()));
  const int rover = model_->jnt_qposadr[mj_name2id(model_.get(), mjOBJ_JOINT, "rover")];
  const Eigen::Quaterniond turn(base_.linear());
  const std::array<double, 7> place = {situation.base.x, situation.base.y, 0,       turn.w(),
                                       turn.x(),         turn.y(),         turn.z()};
  std::ranges::copy(place, data_->qpos + rover);
  // Boxes that nobody knows of are out of the way.
  for (std::size_t number = 0; number < boxes_.size(); ++number)
    place_box(number, Eigen::Isometry3d(Eigen::Translation3d(0, 0, 50 + static_cast<double>(number))));
  for (const BoxPose& box : situation.boxes)
    place_box(static_cast<std::size_t>(box.id), frame_of(box.pose));
  hold(situation.held);
  grasp_ = frame_of(situation.grasp);
  move_to(situation.positions);
}

/// The box moves with the hand from now on (-1: no box), and the fingers are as far apart as it is wide.
void ArmScene::hold(std::int32_t box) {
  held_ = box;
  for (const int finger : fingers_)
    data_->qpos[finger] = held_ >= 0 ? rover::kBoxSide / 2 : rover::kLargestOpening / 2;
  for (std::size_t geom = 0; geom < shapes_.size(); ++geom) {
    if (shapes_[geom].part != Part::Box) continue;
    model_->geom_contype[geom] = shapes_[geom].box == held_ ? 1 : 0;
    model_->geom_margin[geom] = shapes_[geom].box == held_ ? kMargin : 0;
  }
}

std::vector<std::pair<double, double>> ArmScene::limits() {
  std::vector<std::pair<double, double>> limits;
  for (const rover::ArmJoint& joint : rover::kArm)
    limits.emplace_back(joint.lowest, joint.highest);
  return limits;
}

void ArmScene::place_box(std::size_t number, const Eigen::Isometry3d& in_rover) {
  const Eigen::Isometry3d in_room = base_ * in_rover;
  const Eigen::Vector3d position = in_room.translation();
  const Eigen::Quaterniond turn(in_room.linear());
  const std::array<double, 7> values = {position.x(), position.y(), position.z(), turn.w(),
                                        turn.x(),     turn.y(),     turn.z()};
  std::ranges::copy(values, data_->qpos + boxes_.at(number));
}

void ArmScene::move_to(const Positions& positions) {
  for (std::size_t joint = 0; joint < arm_.size(); ++joint)
    data_->qpos[model_->jnt_qposadr[arm_.at(joint)]] = positions[joint];
  mj_kinematics(model_.get(), data_.get());
}

Eigen::Isometry3d ArmScene::tool(const Positions& positions) {
  move_to(positions);
  Eigen::Isometry3d in_room = Eigen::Isometry3d::Identity();
  in_room.translate(vector_of(data_->site_xpos, tool_));
  in_room.rotate(matrix_of(data_->site_xmat, tool_));
  return base_.inverse() * in_room;
}

bool ArmScene::may_touch(const Shape& a, const Shape& b) const {
  const auto moves = [this](const Shape& shape) {
    return shape.part == Part::Arm || shape.part == Part::Hand ||
           (shape.part == Part::Box && shape.box == held_);
  };
  if (!moves(a) && !moves(b)) return true;
  if (a.part == Part::Box && a.box == held_ && b.part == Part::Hand) return true;
  if (a.part == Part::Arm || a.part == Part::Hand) {
    // The joints' limits keep parts from each other that are no more than two joints apart.
    const bool both = b.part == Part::Arm || b.part == Part::Hand;
    return both && std::abs(a.body - b.body) <= 2;
  }
  return false;
}

std::optional<std::string> ArmScene::contact(const Positions& positions, const Tolerance& tolerance) {
  constexpr std::array<const char*, 4> kNames = {"the room", "the rover", "the arm", "the hand"};
  const Eigen::Isometry3d hand = tool(positions);
  if (held_ >= 0) {
    place_box(static_cast<std::size_t>(held_), hand * grasp_);
    mj_kinematics(model_.get(), data_.get());
  }
  mj_collision(model_.get(), data_.get());
  for (int index = 0; index < data_->ncon; ++index) {
    const mjContact& contact = data_->contact[index];
    const Shape& a = shapes_[static_cast<std::size_t>(contact.geom1)];
    const Shape& b = shapes_[static_cast<std::size_t>(contact.geom2)];
    if (may_touch(a, b) || may_touch(b, a)) continue;
    if (tolerance.box >= 0 && (a.box == tolerance.box || b.box == tolerance.box)) continue;
    const auto own = [this](const Shape& shape) {
      return shape.part != Part::Room && (shape.part != Part::Box || shape.box == held_);
    };
    const double least =
        own(a) && own(b) ? std::min(kSelfClearance, tolerance.clearance) : tolerance.clearance;
    if (contact.dist >= least) continue;
    const auto name = [&](const Shape& shape) {
      return shape.part == Part::Box ? "box " + std::to_string(shape.box)
                                     : std::string(kNames.at(static_cast<std::size_t>(shape.part)));
    };
    return name(a) + " and " + name(b);
  }
  return std::nullopt;
}

std::optional<Positions> ArmScene::reach(const Eigen::Isometry3d& pose, const Positions& near) {
  constexpr int kRounds = 150;
  constexpr double kDamping = 0.02;
  constexpr double kClose = 1e-4;       // m and rad
  constexpr double kLargestStep = 0.2;  // rad
  const auto range = limits();
  Positions positions = near;
  using Jacobian = Eigen::Matrix<double, 6, static_cast<int>(rover::kArmJoints)>;
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::Isometry3d at = tool(positions);
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(pose.linear() * at.linear().transpose()));
    Eigen::Matrix<double, 6, 1> error;
    error << base_.linear() * (pose.translation() - at.translation()),
        base_.linear() * (turn.angle() * turn.axis());
    if (error.head<3>().norm() < kClose && error.tail<3>().norm() < kClose) return positions;
    Jacobian jacobian;
    const Eigen::Vector3d tip = vector_of(data_->site_xpos, tool_);
    for (std::size_t joint = 0; joint < arm_.size(); ++joint) {
      const Eigen::Vector3d axis = vector_of(data_->xaxis, arm_.at(joint));
      const Eigen::Vector3d lever = tip - vector_of(data_->xanchor, arm_.at(joint));
      jacobian.col(static_cast<int>(joint)) << axis.cross(lever), axis;
    }
    const Eigen::Matrix<double, 6, 6> damped =
        jacobian * jacobian.transpose() + kDamping * kDamping * Eigen::Matrix<double, 6, 6>::Identity();
    Eigen::Matrix<double, 6, 1> step = jacobian.transpose() * damped.ldlt().solve(error);
    const double largest = step.cwiseAbs().maxCoeff();
    if (largest > kLargestStep) step *= kLargestStep / largest;
    for (std::size_t joint = 0; joint < arm_.size(); ++joint)
      positions[joint] = std::clamp(positions[joint] + step[static_cast<int>(joint)], range[joint].first,
                                    range[joint].second);
  }
  return std::nullopt;
}

}  // namespace planning
