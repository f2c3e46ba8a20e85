// SPDX-License-Identifier: Apache-2.0
#include "frontier_search.hpp"

#include <segue/task/component.hpp>

#include <chrono>
#include <cmath>
#include <optional>

namespace navigation {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Chooses where to drive next in order to see what is unknown.
class FrontierExplorer final : public Component {
 public:
  FrontierExplorer()
      : Component(
            {.doc = "Chooses goals at the border of the unknown until nothing is left that can be reached",
             .activity = segue::periodic(std::chrono::milliseconds(200))}) {}

 private:
  segue::Result<void> on_configure() override {
    if (*most_cells_ < 1 || *most_cells_ > 64'000'000) {
      return segue::fail(segue::ErrorCode::InvalidArgument, "most_cells must be from 1 to 64 million");
    }
    clearance_.emplace(*most_cells_);
    search_.emplace(*most_cells_);
    return {};
  }

  segue::Result<void> on_start() override {
    search_->reset();
    frontier_.reset();
    map_known_ = false;
    return {};
  }

  void on_update() override {
    const bool pose_known = pose_in_.read(pose_) != ReadStatus::NoData;
    const bool map_changed = read_map();
    if (!pose_known || !map_known_ || !on_map()) {
      waiting_.enter();
      return;
    }
    const FrontierSettings settings{*radius_, *smallest_, *size_weight_, *visit_radius_};
    bool choose = map_changed && !frontier_;
    if (frontier_ && (visited() || !progressing())) {
      search_->give_up(frontier_->goal);
      choose = true;
    } else if (frontier_ && map_changed) {
      choose = !search_->worth_while(*clearance_, frontier_->goal, settings);
    }
    if (choose) choose_next(settings);
  }

  void on_cleanup() override {
    search_.reset();
    clearance_.reset();
  }

  bool read_map() {
    const auto map = map_in_.take();
    if (!map) return false;
    if (!clearance_->fits(*map)) {
      log(segue::LogLevel::Error,
          "the map is inconsistent or larger than most_cells: increase that property");
      return false;
    }
    clearance_->update(*map);
    map_known_ = true;
    return true;
  }

  [[nodiscard]] bool on_map() const {
    const GridFrame& frame = clearance_->frame();
    return frame.contains(frame.cell_of({pose_.pose.x, pose_.pose.y}));
  }
  [[nodiscard]] double distance() const {
    return std::hypot(frontier_->goal.x - pose_.pose.x, frontier_->goal.y - pose_.pose.y);
  }
  [[nodiscard]] bool visited() const { return distance() <= *visit_radius_; }

  /// Whether it has moved within the time that it may stand still.
  bool progressing() {
    constexpr double kStoodStill = 0.1;  // m
    if (std::hypot(pose_.pose.x - progress_.x, pose_.pose.y - progress_.y) > kStoodStill) {
      progress_ = pose_.pose;
      progress_time_ = now();
    }
    return now() - progress_time_ <= *patience_;
  }

  void choose_next(const FrontierSettings& settings) {
    frontier_ = search_->next(*clearance_, pose_.pose, settings);
    frontiers_out_.write(static_cast<std::uint32_t>(search_->found()));
    (frontier_ ? exploring_ : explored_).enter();
    if (!frontier_) return;
    progress_ = pose_.pose;
    progress_time_ = now();
    goal_out_.write(frontier_->goal);
  }

  void give_up() {
    if (frontier_) search_->give_up(frontier_->goal);
    frontier_.reset();
  }

  State waiting_{*this, "waiting"};
  State exploring_{*this, "exploring"};
  State explored_{*this, "explored"};
  InputPort<messages::OccupancyGrid> map_in_{*this, "map"};
  InputPort<messages::Odometry> pose_in_{*this, "pose", {.doc = "of the vehicle in the frame of the map"}};
  OutputPort<Pose2D> goal_out_{*this, "goal", {.doc = "where to drive next"}};
  OutputPort<std::uint32_t> frontiers_out_{
      *this, "frontiers", {.doc = "number that is left, this one included"}};
  Property<double> radius_{*this, "radius", 0.3, {.live = true, .doc = "m; as that of the planner"}};
  Property<double> smallest_{
      *this, "smallest", 0.4, {.live = true, .doc = "m; shorter frontiers are not worth a drive"}};
  Property<double> size_weight_{
      *this, "size_weight", 0.5, {.live = true, .doc = "metres of way that a metre of frontier is worth"}};
  Property<double> visit_radius_{
      *this, "visit_radius", 0.35, {.live = true, .doc = "m; distance at which a frontier has been visited"}};
  Property<std::chrono::milliseconds> patience_{
      *this,
      "patience",
      std::chrono::seconds(20),
      {.live = true, .doc = "gives a frontier up when the vehicle has not moved for this time"}};
  Property<std::uint64_t> most_cells_{*this, "most_cells", 1'000'000, {.doc = "of a map"}};
  Operation<void()> give_up_{*this,
                             "give_up",
                             {},
                             [this] { give_up(); },
                             RunsIn::TaskThread,
                             "does not drive to the present goal again; chooses another with the next map"};

  std::optional<ClearanceMap> clearance_;
  std::optional<FrontierSearch> search_;
  std::optional<Frontier> frontier_;
  messages::Odometry pose_;
  bool map_known_ = false;
  Pose2D progress_;  ///< the last place at which it had moved on
  segue::TimePoint progress_time_;
};

}  // namespace navigation

SEGUE_COMPONENT(navigation::FrontierExplorer)
