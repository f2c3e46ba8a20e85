// SPDX-License-Identifier: Apache-2.0
#include "plan_request.hpp"

#include "../rover/rover_model.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

namespace planning {
namespace {

constexpr double kLongestLine = 0.5;  // m
constexpr std::size_t kMostGoals = 64;
constexpr std::uint32_t kMostSteps = 1'000'000;

segue::Error refusal(std::string what) {
  return {segue::ErrorCode::InvalidArgument, std::move(what), {}, {}, {}};
}

bool is_pose(const messages::Pose& pose) {
  return pose.position.allFinite() && pose.orientation.coeffs().allFinite() && pose.orientation.norm() > 1e-6;
}

std::string name_of(std::int32_t box) {
  return "box " + std::to_string(box);
}

segue::Result<void> check_boxes(const Situation& situation) {
  std::set<std::int32_t> seen;
  for (const BoxPose& box : situation.boxes) {
    if (box.id < 0 || box.id >= static_cast<std::int32_t>(rover::kBoxes))
      return refusal("there are boxes 0 to " + std::to_string(rover::kBoxes - 1) + ", not " +
                     std::to_string(box.id));
    if (!seen.insert(box.id).second) return refusal(name_of(box.id) + " is there twice");
    if (!is_pose(box.pose)) return refusal("the pose of " + name_of(box.id) + " is not finite");
  }
  if (situation.held >= 0 && !seen.contains(situation.held))
    return refusal(name_of(situation.held) + " is held, but not among the boxes");
  if (situation.held >= 0 && !is_pose(situation.grasp)) return refusal("from.grasp is not finite");
  return {};
}

segue::Result<void> check(const Situation& situation) {
  if (situation.positions.size() != rover::kArmJoints)
    return refusal("the arm has 6 joints; from.positions has " + std::to_string(situation.positions.size()));
  for (std::size_t joint = 0; joint < rover::kArmJoints; ++joint) {
    if (!std::isfinite(situation.positions[joint]))
      return refusal("from.positions: that of joint " + std::to_string(joint + 1) + " is not finite");
  }
  if (!std::isfinite(situation.base.x) || !std::isfinite(situation.base.y) ||
      !std::isfinite(situation.base.theta))
    return refusal("from.base must consist of finite numbers");
  return check_boxes(situation);
}

segue::Result<void> check_positions(const std::vector<double>& positions) {
  if (positions.size() != rover::kArmJoints)
    return refusal("the arm has 6 joints, not " + std::to_string(positions.size()));
  for (std::size_t joint = 0; joint < rover::kArmJoints; ++joint) {
    const rover::ArmJoint& limits = rover::kArm.at(joint);
    if (!(positions[joint] >= limits.lowest && positions[joint] <= limits.highest))
      return refusal("joint " + std::to_string(joint + 1) + " does not reach that far");
  }
  return {};
}

segue::Result<void> check(const Goal& goal, const Situation& from) {
  if (!goal.positions.empty()) return check_positions(goal.positions);
  if (!is_pose(goal.pose))
    return refusal("the pose must consist of finite numbers and have an orientation that is not zero");
  if (goal.of_held && from.held < 0) return refusal("of_held, but no box is held");
  if (goal.relative_to >= 0 && box_of(from, goal.relative_to) == nullptr)
    return refusal(name_of(goal.relative_to) + " is not among the boxes");
  return {};
}

/// Checks that the hand can do at the end what is requested of it.
segue::Result<void> check_hand(const PlanRequest& request) {
  const Situation& from = request.from;
  if (request.take >= 0 && (box_of(from, request.take) == nullptr || from.held >= 0))
    return refusal(name_of(request.take) + " can be taken only if it is among the boxes and none is held");
  if (request.release && from.held < 0) return refusal("no box is held that could be released");
  return {};
}

}  // namespace

const BoxPose* box_of(const Situation& situation, std::int32_t id) {
  const auto found = std::ranges::find(situation.boxes, id, &BoxPose::id);
  return found == situation.boxes.end() ? nullptr : &*found;
}

segue::Result<void> check(const PlanRequest& request) {
  if (auto checked = check(request.from); !checked) return checked;
  if (request.goals.empty() || request.goals.size() > kMostGoals)
    return refusal("there must be 1 to 64 goals, not " + std::to_string(request.goals.size()));
  if (request.budget < 1 || request.budget > kMostSteps)
    return refusal("budget must be from 1 to 1000000 steps");
  for (const Eigen::Vector3d* line : {&request.leave, &request.approach}) {
    if (!line->allFinite() || line->norm() > kLongestLine)
      return refusal("leave and approach must be finite and no longer than half a metre");
  }
  for (std::size_t index = 0; index < request.goals.size(); ++index) {
    if (auto checked = check(request.goals[index], request.from); !checked)
      return refusal("goals, entry " + std::to_string(index + 1) + ": " + checked.error().message);
  }
  return check_hand(request);
}

}  // namespace planning
