// SPDX-License-Identifier: Apache-2.0
#include "whole_body.hpp"

#include <algorithm>
#include <cmath>

namespace manipulation {

WholeBodySolver::WholeBodySolver(const ArmKinematics& kinematics, const std::vector<JointDescription>& joints,
                                 const std::vector<double>& posture)
    : kinematics_(&kinematics) {
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const JointDescription& joint = joints[i];
    const double middle = std::isfinite(joint.lower + joint.upper) ? 0.5 * (joint.lower + joint.upper) : 0;
    joints_.push_back({joint.lower, joint.upper, joint.velocity, i < posture.size() ? posture[i] : middle});
  }
  const auto size = static_cast<Eigen::Index>(joints_.size());
  lower_ = upper_ = velocities_ = BoxQp::Vector::Zero(size);
}

/// A joint that is closer to the end of its range than the margin, or beyond it, has to come back.
void WholeBodySolver::set_limits(std::span<const double> positions, const WholeBodySettings& settings) {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const auto [lower, upper, velocity, posture] = joints_[i];
    const double up = settings.limit_gain * (upper - settings.limit_margin - positions[i]);
    const double down = settings.limit_gain * (lower + settings.limit_margin - positions[i]);
    const auto index = static_cast<Eigen::Index>(i);
    // Where the margins overlap both ends are too close; then it stays in the middle.
    upper_[index] = std::clamp(std::max(up, 0.5 * (up + down)), -velocity, velocity);
    lower_[index] = std::clamp(std::min(down, 0.5 * (up + down)), -velocity, velocity);
  }
}

std::span<const double> WholeBodySolver::solve(std::span<const double> positions,
                                               const messages::Twist& wanted,
                                               const WholeBodySettings& settings) {
  const ArmKinematics::Jacobian jacobian = kinematics_->jacobian(positions);
  Eigen::Matrix<double, 6, 1> twist;
  twist << wanted.linear, wanted.angular;
  const auto size = static_cast<Eigen::Index>(joints_.size());
  const ArmKinematics::Jacobian weighted = settings.task_weights.asDiagonal() * jacobian;
  BoxQp::Matrix H = BoxQp::Matrix::Identity(size, size) * (settings.damping + settings.posture_weight);
  H.noalias() += weighted.transpose().lazyProduct(jacobian);
  BoxQp::Vector g = -weighted.transpose().lazyProduct(twist);
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const double back = settings.posture_gain * (joints_[i].posture - positions[i]);
    g[static_cast<Eigen::Index>(i)] -= settings.posture_weight * back;
  }
  set_limits(positions, settings);
  qp_.solve(H, g, lower_, upper_, velocities_);
  const Eigen::Matrix<double, 6, 1> missed = twist - jacobian.lazyProduct(velocities_);
  residual_ = std::sqrt(missed.cwiseAbs2().dot(settings.task_weights));
  return {velocities_.data(), joints_.size()};
}

}  // namespace manipulation
