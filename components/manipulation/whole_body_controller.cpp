// SPDX-License-Identifier: Apache-2.0
#include "joint_input.hpp"
#include "twist_input.hpp"
#include "whole_body.hpp"

#include <segue/task/component.hpp>

#include <algorithm>
#include <chrono>
#include <optional>

namespace manipulation {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Moves the tip of an arm with the velocity that is wanted, as far as the limits of the joints allow. Where
/// none is wanted no joint moves, not even towards the posture.
class WholeBodyController final : public Component {
 public:
  WholeBodyController()
      : Component(
            {.doc = "Finds velocities of the joints for a velocity of the tip, within the joints' limits",
             .activity = segue::periodic(std::chrono::milliseconds(10))}) {}

 private:
  segue::Result<void> on_configure() override {
    auto made = ArmKinematics::create(*joint_list_, *tool_);
    if (!made) return std::move(made.error());
    const std::size_t size = made->size();
    if (!posture_->empty() && posture_->size() != size) {
      return segue::fail(segue::ErrorCode::InvalidArgument,
                         "posture must be empty or have as many entries as joints");
    }
    if (!(*damping_ > 0) || !(*posture_weight_ >= 0) || !(task_weights_->minCoeff() >= 0)) {
      return segue::fail(segue::ErrorCode::InvalidArgument,
                         "damping must be positive, and no weight negative");
    }
    kinematics_.emplace(std::move(*made));
    solver_.emplace(*kinematics_, *joint_list_, *posture_);
    command_.positions.clear();
    command_.velocities.assign(size, 0);
    command_out_.prime(command_);
    return {};
  }

  segue::Result<void> on_start() override {
    joints_.begin(kinematics_->size());
    twist_in_.begin();
    return {};
  }

  void on_update() override {
    const bool told = twist_in_.read(now(), *timeout_);
    if (!joints_.read(now(), *timeout_)) {
      waiting_.enter();
      return;
    }
    const messages::Twist& twist = twist_in_.twist();
    if (!told || (twist.linear.isZero(0) && twist.angular.isZero(0))) {
      std::ranges::fill(command_.velocities, 0.0);
      holding_.enter();
    } else {
      const WholeBodySettings settings{*task_weights_, *damping_,    *posture_weight_,
                                       *posture_gain_, *limit_gain_, *limit_margin_};
      std::ranges::copy(solver_->solve(joints_.positions(), twist, settings), command_.velocities.begin());
      residual_out_.write(solver_->residual());
      moving_.enter();
    }
    command_.time = std::chrono::duration<double>(now().time_since_epoch()).count();
    command_out_.write(command_);
  }

  void on_cleanup() override {
    solver_.reset();
    kinematics_.reset();
  }

  State waiting_{*this, "waiting"};
  State holding_{*this, "holding"};
  State moving_{*this, "moving"};
  TwistInput twist_in_{*this, "of the tip, in the frame of the base; zero: no joint moves"};
  JointInput joints_{*this};
  OutputPort<messages::JointCommand> command_out_{*this, "command", {.doc = "velocities"}};
  OutputPort<double> residual_out_{*this, "residual", {.doc = "how much of the wanted velocity is missing"}};
  Property<std::vector<JointDescription>> joint_list_{
      *this, "joint_list", {}, {.doc = "from the base to the tip"}};
  Property<messages::Pose> tool_{*this, "tool", {}, {.doc = "pose of the tip on the last link"}};
  Property<Eigen::Matrix<double, 6, 1>> task_weights_{
      *this,
      "task_weights",
      Eigen::Matrix<double, 6, 1>(Eigen::Matrix<double, 6, 1>::Ones()),
      {.doc = "of the tip's linear, then angular velocity in x, y and z"}};
  Property<double> damping_{*this, "damping", 1e-3, {.doc = "weight of small velocities of the joints"}};
  Property<std::vector<double>> posture_{
      *this, "posture", {}, {.doc = "rad or m; preferred positions; empty: the middle of the ranges"}};
  Property<double> posture_weight_{*this, "posture_weight", 1e-3, {.doc = "of coming closer to the posture"}};
  Property<double> posture_gain_{
      *this, "posture_gain", 0.5, {.live = true, .doc = "1/s; speed towards the posture"}};
  Property<double> limit_gain_{
      *this, "limit_gain", 4.0, {.live = true, .doc = "1/s; speed towards the end of a range, per distance"}};
  Property<double> limit_margin_{
      *this, "limit_margin", 0.02, {.live = true, .doc = "rad or m; ranges end earlier"}};
  Property<std::chrono::milliseconds> timeout_{
      *this,
      "timeout",
      std::chrono::milliseconds(200),
      {.live = true, .doc = "holds where twist or joints are older than this"}};

  std::optional<ArmKinematics> kinematics_;
  std::optional<WholeBodySolver> solver_;
  messages::JointCommand command_;
};

}  // namespace manipulation

SEGUE_COMPONENT(manipulation::WholeBodyController)
