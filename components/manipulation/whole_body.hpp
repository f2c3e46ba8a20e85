// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "arm_kinematics.hpp"
#include "box_qp.hpp"

#include <array>
#include <span>
#include <vector>

namespace manipulation {

struct WholeBodySettings {
  /// Weights of the tip's linear and angular velocities in x, y and z.
  Eigen::Matrix<double, 6, 1> task_weights = Eigen::Matrix<double, 6, 1>::Ones();
  double damping = 1e-3;  ///< weight of the joints' velocities, so that they stay small near singularities
  double posture_weight = 1e-3;  ///< of coming closer to the posture
  double posture_gain = 0.5;     ///< 1/s
  double limit_gain = 4;         ///< 1/s: speed towards the end of a joint's range per distance from it
  double limit_margin = 0.02;    ///< rad or m: the range ends so much earlier
};

/// The velocities of the joints that realise a velocity of the tip as well as they can: the least squares
///   |tip velocity - wanted|^2 by task_weights + damping |joint velocity|^2
///     + posture_weight |joint velocity - posture_gain (posture - position)|^2
/// within the limits of velocity, which decrease towards the ends of the joints' ranges (Kanoun, Lamiraux and
/// Wieber, "Kinematic control of redundant manipulators", 2011). The constructor allocates, nothing else
/// does. One thread at a time.
class WholeBodySolver {
 public:
  /// Requires as many joints as `kinematics` has, and kinematics that live longer. An empty posture is the
  /// middle of the ranges.
  WholeBodySolver(const ArmKinematics& kinematics, const std::vector<JointDescription>& joints,
                  const std::vector<double>& posture);

  /// Requires one position for each joint, and positive damping. The span is valid until the next call.
  std::span<const double> solve(std::span<const double> positions, const messages::Twist& wanted,
                                const WholeBodySettings& settings);
  /// How much of the wanted velocity (weighted) the last solution does not realise.
  [[nodiscard]] double residual() const { return residual_; }

 private:
  struct Joint {
    double lower;
    double upper;
    double velocity;
    double posture;
  };
  void set_limits(std::span<const double> positions, const WholeBodySettings& settings);

  const ArmKinematics* kinematics_;
  std::vector<Joint> joints_;
  BoxQp qp_;
  BoxQp::Vector lower_;
  BoxQp::Vector upper_;
  BoxQp::Vector velocities_;
  double residual_ = 0;
};

}  // namespace manipulation
