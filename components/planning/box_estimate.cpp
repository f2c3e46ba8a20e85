// SPDX-License-Identifier: Apache-2.0
#include "box_estimate.hpp"

#include <algorithm>
#include <cmath>

namespace planning {
namespace {

constexpr double kQuarter = M_PI / 2;

double yaw_of(const messages::Pose& pose) {
  return 2 * std::atan2(pose.orientation.z(), pose.orientation.w());
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace

messages::Pose upright(const messages::Pose& cube) {
  const Eigen::Matrix3d axes = cube.orientation.normalized().toRotationMatrix();
  // The axis that lies flattest tells the turn.
  Eigen::Index flattest = 0;
  axes.row(2).cwiseAbs().minCoeff(&flattest);
  const double turn = std::remainder(std::atan2(axes(1, flattest), axes(0, flattest)), kQuarter);
  return {cube.position, Eigen::Quaterniond(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()))};
}

void BoxEstimate::add(std::int32_t id, const messages::Pose& pose) {
  if (!pose.position.allFinite() || !pose.orientation.coeffs().allFinite() ||
      !(pose.orientation.norm() > 1e-6))
    return;
  std::vector<Sight>& seen = seen_[id];
  if (seen.size() == images_) seen.erase(seen.begin());
  seen.push_back({image_, upright(pose)});
}

std::optional<messages::Pose> BoxEstimate::pose(std::int32_t id) const {
  const auto found = seen_.find(id);
  if (found == seen_.end() || found->second.size() < images_) return std::nullopt;
  const std::vector<Sight>& seen = found->second;
  if (image_ - seen.front().image > 3 * images_) return std::nullopt;
  messages::Pose estimate;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Sight& one : seen)
      values.push_back(one.pose.position[axis]);
    estimate.position[axis] = median(std::move(values));
  }
  // Turns by quarters look the same: those of the others are taken near that of the last one.
  const double reference = yaw_of(seen.back().pose);
  std::vector<double> turns;
  for (const Sight& one : seen)
    turns.push_back(std::remainder(yaw_of(one.pose) - reference, kQuarter));
  const double turn = std::remainder(reference + median(std::move(turns)), kQuarter);
  estimate.orientation = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ());
  return estimate;
}

}  // namespace planning
