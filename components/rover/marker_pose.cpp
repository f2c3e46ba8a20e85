// SPDX-License-Identifier: Apache-2.0
#include "marker_pose.hpp"

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <cmath>

namespace rover {
namespace {

using Residuals = Eigen::Matrix<double, 8, 1>;
using Jacobian = Eigen::Matrix<double, 8, 6>;

/// Corner positions of the marker, in its own frame, in the order of Corners.
std::array<Eigen::Vector3d, 4> corners_of(double side) {
  const double half = side / 2;
  return {{{-half, half, 0}, {half, half, 0}, {half, -half, 0}, {-half, -half, 0}}};
}

/// The rotation and translation that a homography consists of, were there no noise.
messages::Pose decomposed(const Eigen::Matrix3d& homography, double side, const Projection& projection) {
  Eigen::Matrix3d camera = Eigen::Matrix3d::Identity();
  camera(0, 0) = camera(1, 1) = projection.focal_length;
  camera(0, 2) = projection.centre_x;
  camera(1, 2) = projection.centre_y;
  Eigen::Matrix3d columns = camera.inverse() * homography;
  columns /= std::copysign(std::sqrt(columns.col(0).norm() * columns.col(1).norm()), columns(2, 2));
  Eigen::Matrix3d rotation;
  rotation << columns.col(0), columns.col(1), columns.col(0).cross(columns.col(1));
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(rotation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  rotation = svd.matrixU() * svd.matrixV().transpose();
  return {columns.col(2) * side / 2, Eigen::Quaterniond(rotation)};
}

/// Distances in pixels between where the corners are and where they would be; and how those change with small
/// rotations about the marker's centre and translations, in the frame of the camera.
void linearise(const messages::Pose& pose, const Corners& corners, double side, const Projection& projection,
               Residuals& residuals, Jacobian& jacobian) {
  const auto places = corners_of(side);
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d arm = pose.orientation * places.at(static_cast<std::size_t>(i));
    const Eigen::Vector3d point = arm + pose.position;
    const double scale = projection.focal_length / point.z();
    const Eigen::Vector2d seen(projection.centre_x + scale * point.x(),
                               projection.centre_y + scale * point.y());
    residuals.segment<2>(Eigen::Index{2} * i) = corners.at(static_cast<std::size_t>(i)) - seen;
    Eigen::Matrix<double, 2, 3> by_point;
    by_point << scale, 0, -scale * point.x() / point.z(), 0, scale, -scale * point.y() / point.z();
    Eigen::Matrix3d by_rotation;
    by_rotation << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
    jacobian.block<2, 3>(Eigen::Index{2} * i, 0) = by_point * by_rotation;
    jacobian.block<2, 3>(Eigen::Index{2} * i, 3) = by_point;
  }
}

/// Moves the pose to the nearest minimum of the squared distances (Gauss-Newton) and returns it.
double refine(messages::Pose& pose, const Corners& corners, double side, const Projection& projection) {
  constexpr int kRounds = 15;
  Residuals residuals;
  Jacobian jacobian;
  for (int round = 0; round < kRounds; ++round) {
    linearise(pose, corners, side, projection, residuals, jacobian);
    const Eigen::Matrix<double, 6, 1> change =
        (jacobian.transpose() * jacobian).ldlt().solve(jacobian.transpose() * residuals);
    const double angle = change.head<3>().norm();
    if (angle > 1e-12) {
      const Eigen::AngleAxisd turn(angle, change.head<3>() / angle);
      pose.orientation = (turn * pose.orientation).normalized();
    }
    pose.position += change.tail<3>();
  }
  linearise(pose, corners, side, projection, residuals, jacobian);
  return residuals.squaredNorm();
}

}  // namespace

messages::Pose marker_pose(const Corners& corners, const Eigen::Matrix3d& homography, double side,
                           const Projection& projection) {
  messages::Pose pose = decomposed(homography, side, projection);
  const double error = refine(pose, corners, side, projection);
  const Eigen::Vector3d sight = pose.position.normalized();
  const Eigen::Vector3d normal = pose.orientation * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d mirrored = 2 * normal.dot(sight) * sight - normal;
  messages::Pose other = pose;
  other.orientation = Eigen::Quaterniond::FromTwoVectors(normal, mirrored) * pose.orientation;
  return refine(other, corners, side, projection) < error && other.position.z() > 0 ? other : pose;
}

}  // namespace rover
