// SPDX-License-Identifier: Apache-2.0
#include "motion_plan.hpp"

#include "path_search.hpp"
#include "plan_request.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace planning {
namespace {

constexpr double kClearance = 0.01;  // m
// The tool, at most 0.82 m from the first axis, moves by less than the clearance from one check to the next.
constexpr double kResolution = 0.012;       // rad
constexpr double kLineStep = 0.01;          // m, between the points of a straight line
constexpr double kLargestJump = 0.3;        // rad, of a joint on a step of a straight line
constexpr double kSlack = 0.03;             // rad, by which an arm may be beyond its limits at the beginning
constexpr int kSeeds = 24;                  // configurations from which inverse kinematics begin
constexpr std::size_t kConfigurations = 2;  // for each pose

/// Where the tool is to be, and the goal of the request that says so.
struct Target {
  std::int32_t goal = 0;
  Positions positions;  ///< instead of the pose
  Eigen::Isometry3d tool = Eigen::Isometry3d::Identity();
};

/// A configuration in which the search may end, and the straight line from there to the goal.
struct Candidate {
  std::int32_t goal = 0;
  Positions end;
  std::vector<Positions> line;
  double least_cost = 0;
};

double farthest(const Positions& a, const Positions& b) {
  double largest = 0;
  for (std::size_t joint = 0; joint < a.size(); ++joint)
    largest = std::max(largest, std::abs(a[joint] - b[joint]));
  return largest;
}

class MotionPlan {
 public:
  MotionPlan(ArmScene& scene, const PlanRequest& request)
      : scene_(scene), request_(request), random_(request.seed) {}

  segue::Result<PlanResult> run() {
    scene_.set(request_.from);
    if (const std::string why = begin(); !why.empty()) return nothing(why);
    for (const Target& target : targets())
      add_candidates(target);
    std::ranges::stable_sort(candidates_, {}, &Candidate::least_cost);
    std::uint64_t number = 0;
    for (const Candidate& candidate : candidates_) {
      search(candidate, number++);
      if (request_.first && best_) break;
    }
    if (!best_) return nothing(why_);
    return *best_;
  }

 private:
  static segue::Error nothing(const std::string& why) {
    return {segue::ErrorCode::NotFound, "there is no path: " + why, {}, {}, {}};
  }

  /// The tolerance on straight lines, where the box in question stands on something.
  [[nodiscard]] Tolerance at_lines() const {
    return {0, request_.from.held >= 0 ? request_.from.held : request_.take};
  }

  /// The straight line at the beginning; the reason where that is not possible.
  std::string begin() {
    Positions start = request_.from.positions;
    const auto limits = ArmScene::limits();
    for (std::size_t joint = 0; joint < start.size(); ++joint) {
      const double within = std::clamp(start[joint], limits[joint].first, limits[joint].second);
      if (std::abs(within - start[joint]) > kSlack)
        return "at its beginning joint " + std::to_string(joint + 1) + " is beyond its limits";
      start[joint] = within;
    }
    const auto touching = scene_.contact(start, at_lines());
    if (touching) return "at its beginning there is contact between " + *touching;
    beginning_ = {start};
    if (request_.leave.norm() < 1e-9) return {};
    Eigen::Isometry3d end = scene_.tool(start);
    end.pretranslate(request_.leave);
    auto line = straight(start, end);
    if (!line) return "the straight line at its beginning is not possible: " + why_;
    beginning_ = std::move(*line);
    return {};
  }

  /// A straight line in small steps from `from` to the pose `to` of the tool, which has the same orientation.
  std::optional<std::vector<Positions>> straight(const Positions& from, const Eigen::Isometry3d& to) {
    const Eigen::Vector3d begin = scene_.tool(from).translation();
    const Eigen::Vector3d way = to.translation() - begin;
    const int steps = std::max(1, static_cast<int>(std::ceil(way.norm() / kLineStep)));
    std::vector<Positions> line = {from};
    for (int step = 1; step <= steps; ++step) {
      Eigen::Isometry3d pose = to;
      pose.translation() = begin + way * step / steps;
      auto next = scene_.reach(pose, line.back());
      if (!next || farthest(*next, line.back()) > kLargestJump) {
        why_ = "the arm cannot follow it";
        return std::nullopt;
      }
      if (const auto touching = scene_.contact(*next, at_lines())) {
        why_ = "contact between " + *touching;
        return std::nullopt;
      }
      line.push_back(std::move(*next));
    }
    return line;
  }

  [[nodiscard]] std::vector<Target> targets() const {
    std::vector<Target> targets;
    for (std::size_t index = 0; index < request_.goals.size(); ++index) {
      const Goal& goal = request_.goals[index];
      const auto number = static_cast<std::int32_t>(index);
      if (!goal.positions.empty()) {
        targets.push_back({number, goal.positions, {}});
        continue;
      }
      const BoxPose* const box = box_of(request_.from, goal.relative_to);
      const Eigen::Isometry3d frame = box == nullptr ? Eigen::Isometry3d::Identity() : frame_of(box->pose);
      for (int turns = 0; turns < (goal.quarter_turns ? 4 : 1); ++turns) {
        const Eigen::AngleAxisd turn(turns * M_PI / 2, Eigen::Vector3d::UnitZ());
        const Eigen::Isometry3d tool =
            goal.of_held ? frame * frame_of(goal.pose) * turn * frame_of(request_.from.grasp).inverse()
                         : frame * turn * frame_of(goal.pose);
        targets.push_back({number, {}, tool});
      }
    }
    return targets;
  }

  void add_candidates(const Target& target) {
    if (!target.positions.empty()) {
      add(target.goal, target.positions, {target.positions});
      return;
    }
    Eigen::Isometry3d before = target.tool;
    before.pretranslate(request_.approach);
    std::vector<Positions> found = configurations(before);
    if (found.empty()) why_ = about(target.goal, why_);
    for (Positions& end : found) {
      if (request_.approach.norm() < 1e-9) {
        add(target.goal, end, {end});
      } else if (auto line = straight(end, target.tool)) {
        add(target.goal, end, std::move(*line));
      } else {
        why_ = about(target.goal, "the straight line at its end is not possible: " + why_);
      }
    }
  }

  void add(std::int32_t goal, const Positions& end, std::vector<Positions> line) {
    const Tolerance tolerance = line.size() > 1 ? Tolerance{kClearance, -1} : at_lines();
    if (const auto touching = scene_.contact(end, tolerance)) {
      why_ = about(goal, "contact between " + *touching);
      return;
    }
    const double cost = farthest(beginning_.back(), end) + cost_of(line);
    candidates_.push_back({goal, end, std::move(line), cost});
  }

  static std::string about(std::int32_t goal, const std::string& what) {
    return "goal " + std::to_string(goal + 1) + ": " + what;
  }

  /// Different free ones with that pose of the tool, the nearest first; the reason where there is none.
  std::vector<Positions> configurations(const Eigen::Isometry3d& tool) {
    constexpr double kSame = 0.05;  // rad
    std::vector<Positions> found;
    const auto limits = ArmScene::limits();
    for (int seed = 0; seed < kSeeds; ++seed) {
      Positions from = beginning_.back();
      for (std::size_t joint = 0; seed > 0 && joint < from.size(); ++joint)
        from[joint] = std::uniform_real_distribution(limits[joint].first, limits[joint].second)(random_);
      auto reached = scene_.reach(tool, from);
      if (!reached) continue;
      const auto same = [&](const Positions& other) { return farthest(other, *reached) < kSame; };
      if (std::ranges::none_of(found, same)) found.push_back(std::move(*reached));
    }
    if (found.empty()) why_ = "no configuration of the arm has that pose";
    std::ranges::stable_sort(found, {},
                             [this](const Positions& one) { return farthest(beginning_.back(), one); });
    // A few more than are used: some are not free.
    std::erase_if(found, [&](const Positions& one) {
      const auto touching =
          scene_.contact(one, request_.approach.norm() < 1e-9 ? at_lines() : Tolerance{kClearance, -1});
      if (touching) why_ = "contact between " + *touching;
      return touching.has_value();
    });
    if (found.size() > kConfigurations) found.resize(kConfigurations);
    return found;
  }

  void search(const Candidate& candidate, std::uint64_t number) {
    const double before = cost_of(beginning_);
    if (best_ && before + candidate.least_cost >= best_->cost) return;
    const Tolerance at_end = at_lines();
    const bool lines = candidate.line.size() > 1;
    SearchSpace space{ArmScene::limits(),
                      [&](const Positions& positions) {
                        const bool is_end =
                            positions == beginning_.back() || (!lines && positions == candidate.end);
                        return !scene_.contact(positions, is_end ? at_end : Tolerance{kClearance, -1});
                      },
                      kResolution};
    auto path = find_path(space, beginning_.back(), candidate.end,
                          {request_.budget, request_.seed + number, request_.first});
    if (!path) {
      why_ = about(candidate.goal,
                   "no way there was found within " + std::to_string(request_.budget) + " steps");
      return;
    }
    std::vector<Positions> whole = beginning_;
    whole.insert(whole.end(), path->begin() + 1, path->end());
    whole.insert(whole.end(), candidate.line.begin() + 1, candidate.line.end());
    const double cost = cost_of(whole);
    if (best_ && cost >= best_->cost) return;
    best_ = PlanResult{.path = {std::move(whole)}, .cost = cost, .goal = candidate.goal, .after = {}};
    best_->after = after(best_->path.points.back());
  }

  /// The situation after the motion.
  Situation after(const Positions& end) {
    Situation situation = request_.from;
    situation.positions = end;
    const Eigen::Isometry3d tool = scene_.tool(end);
    if (request_.take >= 0) {
      situation.held = request_.take;
      situation.grasp = pose_of(tool.inverse() * frame_of(box_of(request_.from, request_.take)->pose));
    }
    for (BoxPose& box : situation.boxes) {
      if (box.id == request_.from.held) box.pose = pose_of(tool * frame_of(request_.from.grasp));
    }
    if (request_.release) {
      situation.held = -1;
      situation.grasp = {};
    }
    return situation;
  }

  ArmScene& scene_;
  const PlanRequest& request_;
  std::mt19937_64 random_;
  std::vector<Positions> beginning_;  ///< its straight line, or where the arm is
  std::vector<Candidate> candidates_;
  std::optional<PlanResult> best_;
  std::string why_;
};

}  // namespace

segue::Result<PlanResult> plan_motion(ArmScene& scene, const PlanRequest& request) {
  if (auto checked = check(request); !checked) return std::move(checked.error());
  return MotionPlan(scene, request).run();
}

}  // namespace planning
