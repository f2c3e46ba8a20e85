// SPDX-License-Identifier: Apache-2.0
#include "grid_search.hpp"
#include "types.hpp"

#include <segue/task/component.hpp>

#include <chrono>
#include <cmath>
#include <optional>

namespace navigation {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Finds paths to a goal: again with each new map, so that the path stays one of the present map.
class PathPlanner final : public Component {
 public:
  PathPlanner()
      : Component({.doc = "Finds the path to a goal in a map, or says why there is none",
                   .activity = segue::periodic(std::chrono::milliseconds(100))}) {}

 private:
  static constexpr std::uint64_t kMostCells = 64'000'000;

  segue::Result<void> on_configure() override {
    if (*most_cells_ < 1 || *most_cells_ > kMostCells || *most_poses_ < 2 || *most_poses_ > 65536) {
      return segue::fail(segue::ErrorCode::InvalidArgument,
                         "most_cells must be from 1 to 64 million and most_poses from 2 to 65536");
    }
    clearance_.emplace(*most_cells_);
    search_.emplace(*most_cells_, *most_poses_);
    path_.poses.resize(*most_poses_);
    path_out_.prime(path_);
    return {};
  }

  segue::Result<void> on_start() override {
    goal_.reset();
    map_ = MapState::None;
    reported_ = PlanProblem::None;
    progress_ = {};
    return {};
  }

  void on_update() override {
    pose_known_ = pose_in_.read(pose_) != ReadStatus::NoData;
    const bool map_changed = read_map();
    messages::Pose2D goal;
    if (goal_in_.read(goal) == ReadStatus::NewData) set_goal(goal);
    const bool has_moved = progress_in_.read(progress_) == ReadStatus::NewData;
    if (!goal_) {
      idle_.enter();
      if (goal_changed_) report(PlanProblem::NoGoal);
    } else if (goal_changed_ || map_changed) {
      plan();
    } else if (has_moved && reported_ == PlanProblem::None) {
      (arrived() ? arrived_ : planned_).enter();
    }
    goal_changed_ = false;
  }

  void on_cleanup() override {
    search_.reset();
    clearance_.reset();
  }

  bool read_map() {
    const auto map = map_in_.take();
    if (!map) return false;
    map_ = clearance_->fits(*map) ? MapState::Valid : MapState::Invalid;
    if (map_ == MapState::Valid) clearance_->update(*map);
    return true;
  }

  void plan() {
    path_.poses.clear();
    PlanProblem problem = PlanProblem::None;
    if (!pose_known_) {
      problem = PlanProblem::NoPose;
    } else if (map_ != MapState::Valid) {
      problem = map_ == MapState::None ? PlanProblem::NoMap : PlanProblem::InvalidMap;
    } else {
      const PlanSettings settings{*radius_,        *comfort_,      *comfort_weight_,
                                  *cross_unknown_, *unknown_cost_, *goal_tolerance_};
      problem = search_->plan(*clearance_, pose_.pose, *goal_, settings, path_);
    }
    report(problem);
  }

  /// Whether the pose or the map has not arrived yet, which is no reason to give up.
  static bool is_waiting(PlanProblem problem) {
    return problem == PlanProblem::NoPose || problem == PlanProblem::NoMap;
  }
  void report(PlanProblem problem) {
    const bool found = problem == PlanProblem::None;
    if (!found) path_.poses.clear();
    if (goal_) (found ? arrived() ? arrived_ : planned_ : is_waiting(problem) ? waiting_ : no_path_).enter();
    if (!found && problem != reported_ && goal_) log(segue::LogLevel::Warning, explain(problem));
    reported_ = problem;
    double length = 0;
    for (std::size_t i = 1; i < path_.poses.size(); ++i)
      length += std::hypot(path_.poses[i].x - path_.poses[i - 1].x, path_.poses[i].y - path_.poses[i - 1].y);
    path_.goal = goal_.value_or(Pose2D{});
    path_out_.write(path_);
    status_out_.write({goal_.value_or(Pose2D{}), problem, length});
  }

  void set_goal(const Pose2D& goal) {
    goal_ = goal;
    goal_changed_ = true;
  }
  /// At this goal: the vehicle may still tell that it is at the one before.
  [[nodiscard]] bool arrived() const { return progress_.arrived && is_same(progress_.goal, *goal_); }
  void clear_goal() {
    goal_.reset();
    goal_changed_ = true;
  }

  enum class MapState : std::uint8_t { None, Invalid, Valid };

  State idle_{*this, "idle"};
  State waiting_{*this, "waiting"};
  State planned_{*this, "planned"};
  State arrived_{*this, "arrived"};
  State no_path_{*this, "no_path"};
  InputPort<messages::OccupancyGrid> map_in_{*this, "map"};
  InputPort<messages::Odometry> pose_in_{*this, "pose", {.doc = "of the vehicle in the frame of the map"}};
  InputPort<Pose2D> goal_in_{*this, "goal", {.doc = "in the frame of the map; replaces that of set_goal"}};
  InputPort<DriveProgress> progress_in_{
      *this, "progress", {.doc = "of whoever drives along the path: the state arrived follows from it"}};
  OutputPort<messages::Path> path_out_{*this, "path", {.doc = "without poses where there is none"}};
  OutputPort<PlanStatus> status_out_{*this, "status", {.doc = "of every attempt, with why there is no path"}};
  Property<double> radius_{
      *this, "radius", 0.3, {.live = true, .doc = "m; distance that paths keep from what is occupied"}};
  Property<double> comfort_{
      *this, "comfort", 0.6, {.live = true, .doc = "m; distance from obstacles that is worth a detour"}};
  Property<double> comfort_weight_{
      *this, "comfort_weight", 3.0, {.live = true, .doc = "relative length of such a detour"}};
  Property<bool> cross_unknown_{
      *this, "cross_unknown", true, {.live = true, .doc = "plan through unknown cells"}};
  Property<double> unknown_cost_{
      *this, "unknown_cost", 2.0, {.live = true, .doc = "cost of a metre in unknown cells"}};
  Property<double> goal_tolerance_{
      *this,
      "goal_tolerance",
      0.3,
      {.live = true, .doc = "m; how far from the goal a path may end where the goal is not free"}};
  Property<std::uint64_t> most_cells_{*this, "most_cells", 1'000'000, {.doc = "of a map"}};
  Property<std::uint32_t> most_poses_{*this, "most_poses", 256, {.doc = "of a path"}};
  Operation<segue::Result<void>(Pose2D)> set_goal_{
      *this,
      "set_goal",
      {"goal"},
      [this](const Pose2D& goal) -> segue::Result<void> {
        if (!is_finite(goal))
          return segue::fail(segue::ErrorCode::InvalidArgument, "the goal must consist of finite numbers");
        set_goal(goal);
        (arrived() ? arrived_ : waiting_)
            .enter();  // the state is of this goal, whatever it was of the last one
        return {};
      },
      RunsIn::TaskThread,
      "plans paths to this pose from now on"};
  Operation<void()> clear_goal_{*this,
                                "clear_goal",
                                {},
                                [this] { clear_goal(); },
                                RunsIn::TaskThread,
                                "forgets the goal; the path ends"};

  std::optional<ClearanceMap> clearance_;
  std::optional<GridSearch> search_;
  messages::Path path_;
  messages::Odometry pose_;
  DriveProgress progress_;
  std::optional<Pose2D> goal_;
  bool goal_changed_ = false;
  bool pose_known_ = false;
  MapState map_ = MapState::None;
  PlanProblem reported_ = PlanProblem::None;
};

}  // namespace navigation

SEGUE_COMPONENT(navigation::PathPlanner)
