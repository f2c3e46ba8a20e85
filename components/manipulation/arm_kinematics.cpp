// SPDX-License-Identifier: Apache-2.0
#include "arm_kinematics.hpp"

#include <segue/base/text.hpp>

#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include <string>
#include <utility>

namespace manipulation {
namespace {

KDL::Vector vector_of(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

KDL::Frame frame_of(const messages::Pose& pose) {
  const Eigen::Quaterniond q = pose.orientation.normalized();
  return {KDL::Rotation::Quaternion(q.x(), q.y(), q.z(), q.w()), vector_of(pose.position)};
}

KDL::Segment segment_of(const JointDescription& joint) {
  const KDL::Frame origin(KDL::Rotation::RPY(joint.rpy.x(), joint.rpy.y(), joint.rpy.z()),
                          vector_of(joint.xyz));
  const KDL::Vector axis = origin.M * vector_of(joint.axis.normalized());
  const auto type = joint.prismatic ? KDL::Joint::TransAxis : KDL::Joint::RotAxis;
  return KDL::Segment(joint.name, KDL::Joint(joint.name, origin.p, axis, type), origin);
}

bool usable(const JointDescription& joint) {
  return joint.xyz.allFinite() && joint.rpy.allFinite() && joint.axis.allFinite() &&
         joint.axis.norm() > 1e-6 && joint.lower <= joint.upper && joint.velocity > 0;
}

}  // namespace

struct ArmKinematics::Chain {
  explicit Chain(const KDL::Chain& made)
      : chain(made),
        positions(chain.getNrOfJoints()),
        jacobian(chain.getNrOfJoints()),
        tip_solver(chain),
        jacobian_solver(chain) {}
  void set(std::span<const double> values) {
    for (unsigned i = 0; i < positions.rows(); ++i)
      positions(i) = values[i];
  }
  KDL::Chain chain;  // the solvers refer to it
  KDL::JntArray positions;
  KDL::Jacobian jacobian;
  KDL::ChainFkSolverPos_recursive tip_solver;
  KDL::ChainJntToJacSolver jacobian_solver;
};

ArmKinematics::ArmKinematics(std::unique_ptr<Chain> chain) : chain_(std::move(chain)) {}
ArmKinematics::ArmKinematics(ArmKinematics&& other) noexcept = default;
ArmKinematics& ArmKinematics::operator=(ArmKinematics&& other) noexcept = default;
ArmKinematics::~ArmKinematics() = default;

segue::Result<ArmKinematics> ArmKinematics::create(const std::vector<JointDescription>& joints,
                                                   const messages::Pose& tool) {
  if (joints.empty() || joints.size() > static_cast<std::size_t>(kMostJoints)) {
    return segue::fail(segue::ErrorCode::InvalidArgument,
                       "an arm has 1 to " + std::to_string(kMostJoints) + " joints, not " +
                           std::to_string(joints.size()) + ": set the property joints");
  }
  KDL::Chain chain;
  for (const JointDescription& joint : joints) {
    if (!usable(joint)) {
      return segue::fail(
          segue::ErrorCode::InvalidArgument,
          "joint " + segue::quote(joint.name) +
              " needs finite numbers, an axis that is not zero, lower <= upper and velocity > 0");
    }
    chain.addSegment(segment_of(joint));
  }
  if (!tool.position.allFinite() || !(tool.orientation.norm() > 1e-6)) {
    return segue::fail(segue::ErrorCode::InvalidArgument,
                       "the pose of the tool must consist of finite numbers");
  }
  chain.addSegment(KDL::Segment("tool", KDL::Joint("tool", KDL::Joint::None), frame_of(tool)));
  return ArmKinematics(std::make_unique<Chain>(std::move(chain)));
}

std::size_t ArmKinematics::size() const {
  return chain_->chain.getNrOfJoints();
}

messages::Pose ArmKinematics::tip(std::span<const double> positions) const {
  chain_->set(positions);
  KDL::Frame frame;
  chain_->tip_solver.JntToCart(chain_->positions, frame);
  messages::Pose pose;
  pose.position = {frame.p.x(), frame.p.y(), frame.p.z()};
  frame.M.GetQuaternion(pose.orientation.x(), pose.orientation.y(), pose.orientation.z(),
                        pose.orientation.w());
  return pose;
}

ArmKinematics::Jacobian ArmKinematics::jacobian(std::span<const double> positions) const {
  chain_->set(positions);
  chain_->jacobian_solver.JntToJac(chain_->positions, chain_->jacobian);
  return chain_->jacobian.data;
}

}  // namespace manipulation
