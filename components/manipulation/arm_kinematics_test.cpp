// SPDX-License-Identifier: Apache-2.0
#include "arm_kinematics.hpp"
#include "pose_servo.hpp"
#include "test_arm.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

namespace manipulation {
namespace {

double a_number(double low, double high) {
  return low + (high - low) * *rc::gen::inRange(0, 1'000'001) / 1e6;
}

Eigen::Vector3d a_vector(double largest) {
  return {a_number(-largest, largest), a_number(-largest, largest), a_number(-largest, largest)};
}

std::vector<JointDescription> a_chain() {
  std::vector<JointDescription> joints(*rc::gen::inRange<std::size_t>(1, 9));
  for (JointDescription& joint : joints) {
    joint.xyz = a_vector(1);
    joint.rpy = a_vector(3);
    joint.axis = a_vector(1) + Eigen::Vector3d(1.5, 0, 0);
    joint.prismatic = *rc::gen::inRange(0, 4) == 0;
  }
  return joints;
}

/// By products of transformations.
Eigen::Isometry3d tip_of(const std::vector<JointDescription>& joints, const std::vector<double>& positions) {
  Eigen::Isometry3d tip = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const JointDescription& joint = joints[i];
    tip.translate(joint.xyz);
    tip.rotate(Eigen::AngleAxisd(joint.rpy.z(), Eigen::Vector3d::UnitZ()) *
               Eigen::AngleAxisd(joint.rpy.y(), Eigen::Vector3d::UnitY()) *
               Eigen::AngleAxisd(joint.rpy.x(), Eigen::Vector3d::UnitX()));
    const Eigen::Vector3d axis = joint.axis.normalized();
    if (joint.prismatic)
      tip.translate(Eigen::Vector3d(positions[i] * axis));
    else
      tip.rotate(Eigen::AngleAxisd(positions[i], axis));
  }
  return tip;
}

RC_GTEST_PROP(ArmKinematics, TheTipIsWhereTheJointsPutIt, ()) {
  const auto joints = a_chain();
  const auto arm = ArmKinematics::create(joints);
  RC_ASSERT(arm);
  std::vector<double> positions;
  for (std::size_t i = 0; i < joints.size(); ++i)
    positions.push_back(a_number(-3, 3));
  const Pose tip = arm->tip(positions);
  const Eigen::Isometry3d expected = tip_of(joints, positions);
  RC_ASSERT((tip.position - expected.translation()).norm() < 1e-9);
  RC_ASSERT(tip.orientation.angularDistance(Eigen::Quaterniond(expected.rotation())) < 1e-6);
}

RC_GTEST_PROP(ArmKinematics, TheJacobianIsTheDerivativeOfTheTip, ()) {
  const auto joints = a_chain();
  Pose tool;
  tool.position = a_vector(0.5);
  const auto arm = ArmKinematics::create(joints, tool);
  RC_ASSERT(arm);
  std::vector<double> positions;
  for (std::size_t i = 0; i < joints.size(); ++i)
    positions.push_back(a_number(-3, 3));
  const auto jacobian = arm->jacobian(positions);
  constexpr double kLittle = 1e-6;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    auto before = positions;
    auto behind = positions;
    before[i] -= kLittle;
    behind[i] += kLittle;
    const PoseError change = error_between(arm->tip(before), arm->tip(behind));
    const auto column = jacobian.col(static_cast<Eigen::Index>(i));
    RC_ASSERT((column.head<3>() - change.translation / (2 * kLittle)).norm() < 1e-6);
    RC_ASSERT((column.tail<3>() - change.rotation / (2 * kLittle)).norm() < 1e-6);
  }
}

TEST(ArmKinematics, RefusesChainsThatMakeNoSense) {
  EXPECT_FALSE(ArmKinematics::create({}));
  EXPECT_FALSE(ArmKinematics::create(std::vector<JointDescription>(17)));
  auto joints = test::seven_joints();
  joints[3].axis.setZero();
  const auto made = ArmKinematics::create(joints);
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().message, ::testing::HasSubstr("elbow"));
  Pose nowhere;
  nowhere.position.x() = std::nan("");
  EXPECT_FALSE(ArmKinematics::create(test::seven_joints(), nowhere));
}

RC_GTEST_PROP(PoseServo, VelocitiesLeadToTheTarget, ()) {
  const auto a_pose = [] {
    Pose pose;
    pose.position = a_vector(1);
    const Eigen::Vector3d turn = a_vector(2);
    pose.orientation =
        Eigen::AngleAxisd(turn.norm(), Eigen::Vector3d(turn + Eigen::Vector3d(0, 0, 1e-9)).normalized());
    return pose;
  };
  Pose pose = a_pose();
  Pose target = a_pose();
  if (*rc::gen::arbitrary<bool>()) target.orientation.coeffs() *= -1;  // the same rotation
  const ServoLimits limits{.gain = 3, .speed = 0.5, .turn_rate = 1};
  double distance = 1e9;
  for (int i = 0; i < 1500; ++i) {
    const PoseError error = error_between(pose, target);
    RC_ASSERT(error.rotation.norm() <= M_PI + 1e-9);
    RC_ASSERT(error.translation.norm() <= distance + 1e-12);
    distance = error.translation.norm();
    const Twist twist = velocity_towards(error, limits);
    RC_ASSERT(twist.linear.norm() <= limits.speed + 1e-9);
    RC_ASSERT(twist.angular.norm() <= limits.turn_rate + 1e-9);
    pose.position += 0.01 * twist.linear;
    const double angle = 0.01 * twist.angular.norm();
    if (angle > 0) pose.orientation = Eigen::AngleAxisd(angle, twist.angular.normalized()) * pose.orientation;
  }
  const PoseError left = error_between(pose, target);
  RC_ASSERT(left.translation.norm() < 1e-3 && left.rotation.norm() < 1e-3);
  const Pose same = compose(target, compose(inverse(target), pose));
  RC_ASSERT((same.position - pose.position).norm() < 1e-9);
}

}  // namespace
}  // namespace manipulation
