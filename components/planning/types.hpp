// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../messages/geometry.hpp"
#include "../messages/motion.hpp"

#include <segue/type/describe.hpp>

#include <cstdint>
#include <vector>

/// Requests to a planner of motions and its answers. Poses are in the frame of the rover unless they say
/// otherwise; that of a box lies in its centre. Units and frames: messages/geometry.hpp.
namespace planning {

struct BoxPose {
  std::int32_t id = 0;
  messages::Pose pose;
};

/// All that a plan begins with, and that holds after a motion: the result of one plan is the beginning of the
/// next, so that motions can be planned before those ahead of them have been carried out.
struct Situation {
  messages::Pose2D base;          ///< of the rover, in the frame of the room
  std::vector<double> positions;  ///< of the arm's joints, rad
  std::vector<BoxPose> boxes;
  std::int32_t held = -1;  ///< the box in the hand; -1: none
  messages::Pose grasp;    ///< of the held box, in the frame of the tool
};

/// A candidate for the end of a motion: positions of the joints or, without positions, a pose.
struct Goal {
  std::vector<double> positions;  ///< rad
  messages::Pose pose;            ///< of the tool, or of the held box
  bool of_held = false;           ///< the held box gets to the pose, not the tool
  std::int32_t relative_to = -1;  ///< the box in whose frame the pose is; -1: the rover's
  bool quarter_turns = false;     ///< also those turned by quarters: about z of the box in whose frame it
                                  ///< is, or of the held box in its pose
};

struct PlanRequest {
  Situation from;
  std::vector<Goal> goals;
  /// The motion begins with a straight line of the tool by this vector, and ends with one that comes from
  /// there: both without turning the tool, m.
  Eigen::Vector3d leave = Eigen::Vector3d::Zero();
  Eigen::Vector3d approach = Eigen::Vector3d::Zero();
  std::int32_t take = -1;       ///< the box that is in the hand at the end; -1: none is taken
  bool release = false;         ///< the held box is left where it is at the end
  bool first = false;           ///< the first path that is found will do; otherwise the cheapest one
  std::uint32_t budget = 1000;  ///< steps of search for each candidate
  std::uint64_t seed = 1;       ///< the same request has the same answer
};

struct PlanResult {
  messages::JointPath path;
  double cost = 0;         ///< s that it takes if each joint may turn by 1 rad/s
  std::int32_t goal = -1;  ///< which of the goals it leads to
  Situation after;
};

SEGUE_TYPE(BoxPose, id, pose)
SEGUE_TYPE(Situation, base, positions, boxes, held, grasp)
SEGUE_TYPE(Goal, positions, pose, of_held, relative_to, quarter_turns)
SEGUE_TYPE(PlanRequest, from, goals, leave, approach, take, release, first, budget, seed)
SEGUE_TYPE(PlanResult, path, cost, goal, after)

}  // namespace planning
