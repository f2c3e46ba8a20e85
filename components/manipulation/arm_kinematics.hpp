// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "types.hpp"

#include <segue/base/result.hpp>

#include <Eigen/Core>

#include <memory>
#include <span>

namespace manipulation {

/// Kinematics of a chain of joints, by KDL. create() allocates, nothing else does. One thread at a time.
class ArmKinematics {
 public:
  static constexpr int kMostJoints = 16;
  using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMostJoints>;

  /// `tool` is the pose of the tip in the frame of the last link. InvalidArgument unless there are 1 to
  /// kMostJoints joints with finite numbers, axes that have a direction, and lower <= upper.
  static segue::Result<ArmKinematics> create(const std::vector<JointDescription>& joints,
                                             const messages::Pose& tool = {});
  ArmKinematics(ArmKinematics&& other) noexcept;
  ArmKinematics& operator=(ArmKinematics&& other) noexcept;
  ~ArmKinematics();

  [[nodiscard]] std::size_t size() const;
  /// The pose of the tip in the frame of the base. Requires one position for each joint.
  [[nodiscard]] messages::Pose tip(std::span<const double> positions) const;
  /// Linear, then angular velocity of the tip for velocities of the joints, all in the frame of the base.
  /// Requires one position for each joint.
  [[nodiscard]] Jacobian jacobian(std::span<const double> positions) const;

 private:
  struct Chain;
  explicit ArmKinematics(std::unique_ptr<Chain> chain);
  std::unique_ptr<Chain> chain_;
};

}  // namespace manipulation
