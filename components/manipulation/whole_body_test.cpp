// SPDX-License-Identifier: Apache-2.0
#include "whole_body.hpp"
#include "pose_servo.hpp"
#include "test_arm.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>

namespace manipulation {
namespace {

Eigen::Vector3d random_vector(double largest) {
  const auto one = [=] { return largest * *rc::gen::inRange(-1'000'000, 1'000'001) / 1e6; };
  return {one(), one(), one()};
}

std::vector<double> random_positions(const std::vector<JointDescription>& joints) {
  std::vector<double> positions;
  for (const JointDescription& joint : joints)
    positions.push_back(joint.lower + (joint.upper - joint.lower) * *rc::gen::inRange(0, 1'000'001) / 1e6);
  return positions;
}

TEST(WholeBodySolver, RealisesAVelocityThatIsPossible) {
  const auto joints = test::seven_joints();
  const auto arm = ArmKinematics::create(joints);
  WholeBodySolver solver(*arm, joints, {});
  const auto positions = test::bent();
  const Twist wanted{{0.05, -0.02, 0.03}, {0.1, 0.05, -0.1}};
  WholeBodySettings settings;
  settings.damping = settings.posture_weight = 1e-6;
  const auto velocities = solver.solve(positions, wanted, settings);
  const Eigen::VectorXd found = Eigen::Map<const Eigen::VectorXd>(velocities.data(), 7);
  const Eigen::Matrix<double, 6, 1> tip = arm->jacobian(positions) * found;
  EXPECT_LT((tip.head<3>() - wanted.linear).norm(), 1e-3);
  EXPECT_LT((tip.tail<3>() - wanted.angular).norm(), 1e-3);
  EXPECT_LT(solver.residual(), 1e-3);
}

TEST(WholeBodySolver, UsesItsFreedomToComeCloserToThePosture) {
  const auto joints = test::seven_joints();
  const auto arm = ArmKinematics::create(joints);
  const std::vector<double> posture{0.3, 0.5, 1.0, 1.2, 0.4, 0.8, -0.3};
  WholeBodySolver solver(*arm, joints, posture);
  auto positions = test::bent();
  const Pose start = arm->tip(positions);
  const auto distance = [&] {
    double sum = 0;
    for (std::size_t i = 0; i < 7; ++i)
      sum += std::pow(positions[i] - posture[i], 2);
    return sum;
  };
  const double before = distance();
  for (int i = 0; i < 500; ++i) {
    const PoseError error = error_between(arm->tip(positions), start);
    const auto velocities = solver.solve(positions, velocity_towards(error, {}), {});
    for (std::size_t j = 0; j < 7; ++j)
      positions[j] += 0.01 * velocities[j];
  }
  EXPECT_LT(distance(), 0.9 * before);
  EXPECT_LT((arm->tip(positions).position - start.position).norm(), 0.005) << "while the tip stays";
}

RC_GTEST_PROP(WholeBodySolver, NoJointExceedsItsVelocityOrLeavesItsRange, ()) {
  const auto joints = test::seven_joints();
  const auto arm = ArmKinematics::create(joints);
  WholeBodySolver solver(*arm, joints, {});
  auto positions = random_positions(joints);
  const Twist wanted{random_vector(2), random_vector(4)};
  for (int i = 0; i < 200; ++i) {
    const auto velocities = solver.solve(positions, wanted, {});
    for (std::size_t j = 0; j < joints.size(); ++j) {
      RC_ASSERT(std::abs(velocities[j]) <= joints[j].velocity);
      positions[j] += 0.01 * velocities[j];
      RC_ASSERT(positions[j] >= joints[j].lower && positions[j] <= joints[j].upper);
    }
  }
}

RC_GTEST_PROP(WholeBodySolver, WhatIsBeyondItsRangeComesBack, ()) {
  const auto joints = test::seven_joints();
  const auto arm = ArmKinematics::create(joints);
  WholeBodySolver solver(*arm, joints, {});
  auto positions = random_positions(joints);
  const std::size_t outside = *rc::gen::inRange<std::size_t>(0, 7);
  positions[outside] = joints[outside].upper + 0.2;
  for (int i = 0; i < 300; ++i) {
    const auto velocities = solver.solve(positions, {random_vector(1), random_vector(1)}, {});
    for (std::size_t j = 0; j < joints.size(); ++j)
      positions[j] += 0.01 * velocities[j];
  }
  RC_ASSERT(positions[outside] <= joints[outside].upper);
}

RC_GTEST_PROP(WholeBodySolver, NoOtherVelocityWithinTheLimitsIsBetter, ()) {
  const auto joints = test::seven_joints();
  const auto arm = ArmKinematics::create(joints);
  WholeBodySolver solver(*arm, joints, {});
  const auto positions = random_positions(joints);
  const Twist wanted{random_vector(1), random_vector(3)};
  const WholeBodySettings settings;
  Eigen::Matrix<double, 6, 1> twist;
  twist << wanted.linear, wanted.angular;
  const auto jacobian = arm->jacobian(positions);
  const auto cost = [&](const Eigen::VectorXd& velocities) {
    double sum = (jacobian * velocities - twist).squaredNorm() + settings.damping * velocities.squaredNorm();
    for (std::size_t j = 0; j < 7; ++j) {
      const double back = settings.posture_gain * (0 - positions[j]);
      sum += settings.posture_weight * std::pow(velocities[static_cast<Eigen::Index>(j)] - back, 2);
    }
    return sum;
  };
  const auto solution = solver.solve(positions, wanted, settings);
  const Eigen::VectorXd best = Eigen::Map<const Eigen::VectorXd>(solution.data(), 7);
  for (int i = 0; i < 20; ++i) {
    Eigen::VectorXd other = best;
    for (std::size_t j = 0; j < 7; ++j) {
      const auto index = static_cast<Eigen::Index>(j);
      const double up = 4 * (joints[j].upper - 0.02 - positions[j]);
      const double down = 4 * (joints[j].lower + 0.02 - positions[j]);
      const double step = *rc::gen::element(0.0, 1e-3, 0.1) * *rc::gen::inRange(-10, 11);
      other[index] = std::clamp(other[index] + step, std::clamp(down, -1.5, 1.5), std::clamp(up, -1.5, 1.5));
    }
    RC_ASSERT(cost(best) <= cost(other) + 1e-9);
  }
}

}  // namespace
}  // namespace manipulation
