// SPDX-License-Identifier: Apache-2.0
#include "pose_history.hpp"
#include "scan_matcher.hpp"

#include <segue/task/component.hpp>

#include <optional>

namespace navigation {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Corrects odometry by what the scanner sees in the map. With a mapper that gets the corrected poses, both
/// make a map of what is unknown.
class Localization final : public Component {
 public:
  Localization() : Component({.doc = "Corrects odometry by matching laser scans with a map"}) {}

 private:
  static constexpr std::uint32_t kStateVersion = 1;

  segue::Result<void> on_configure() override {
    if (*most_cells_ < 1 || *most_cells_ > 64'000'000 || *most_points_ < 10 || *most_points_ > 4096 ||
        !(*sharpness_ > 0) || !is_finite(*start_)) {
      return segue::fail(segue::ErrorCode::InvalidArgument,
                         "most_cells must be from 1 to 64 million, most_points from 10 to 4096, sharpness "
                         "positive and start a pose of finite numbers");
    }
    map_.emplace(*most_cells_);
    matcher_.emplace(*most_points_);
    correction_ = *start_;
    return {};
  }

  segue::Result<void> on_start() override {
    history_.clear();
    map_known_ = false;
    matched_ = false;
    return {};
  }

  void on_update() override {
    if (const auto map = map_in_.take()) {
      map_known_ = map_->fits(*map);
      if (map_known_)
        map_->update(*map);
      else
        log(segue::LogLevel::Error,
            "the map is inconsistent or larger than most_cells: increase that property");
    }
    bool moved_on = false;
    messages::Odometry odometry;
    while (odometry_in_.read(odometry) == ReadStatus::NewData) {
      history_.add(odometry);
      moved_on = true;
    }
    while (const auto scan = scan_in_.take())
      correct(*scan);
    if (history_.empty()) {
      waiting_.enter();
      return;
    }
    (matched_ ? localized_ : odometry_).enter();
    if (!moved_on) return;
    odometry = history_.newest();
    odometry.pose = compose(correction_, odometry.pose);
    pose_out_.write(odometry);
  }

  void on_cleanup() override {
    matcher_.reset();
    map_.reset();
  }

  std::optional<SavedState> save_state() override { return make_state(correction_, kStateVersion); }
  segue::Result<void> restore_state(const SavedState& state) override {
    auto correction = read_state<Pose2D>(state, kStateVersion);
    if (!correction) return std::move(correction.error());
    correction_ = *correction;
    return {};
  }

  void correct(const messages::LaserScan& scan) {
    const auto driven = history_.at(scan.time);
    matched_ = false;
    if (!map_known_ || !driven) return;
    const Pose2D guess = compose(compose(correction_, *driven), *sensor_);
    const MatchSettings settings{*window_, *angle_window_, *sharpness_, *guess_weight_, *longest_beam_};
    const auto match = matcher_->match(*map_, scan, guess, settings);
    if (!match) return;
    score_out_.write(match->score);
    if (match->score < *least_score_) return;
    matched_ = true;
    correction_ = compose(compose(match->pose, inverse(*sensor_)), inverse(*driven));
  }

  segue::Result<void> set_pose(const Pose2D& pose) {
    if (!is_finite(pose))
      return segue::fail(segue::ErrorCode::InvalidArgument, "the pose must consist of finite numbers");
    if (history_.empty())
      return segue::fail(segue::ErrorCode::InvalidState,
                         "no odometry has arrived yet: connect the port odometry");
    correction_ = compose(pose, inverse(history_.newest().pose));
    return {};
  }

  State waiting_{*this, "waiting"};
  State odometry_{*this, "odometry"};
  State localized_{*this, "localized"};
  InputPort<messages::Odometry> odometry_in_{*this, "odometry"};
  InputPort<messages::LaserScan> scan_in_{*this, "scan"};
  InputPort<messages::OccupancyGrid> map_in_{*this, "map"};
  OutputPort<messages::Odometry> pose_out_{*this, "pose", {.doc = "of the vehicle in the frame of the map"}};
  OutputPort<double> score_out_{
      *this, "score", {.doc = "from 0 to 1: how well the last scan fitted the map"}};
  Property<Pose2D> start_{*this, "start", {}, {.doc = "where the frame of the odometry lies in the map"}};
  Property<Pose2D> sensor_{*this, "sensor", {}, {.live = true, .doc = "pose of the scanner on the vehicle"}};
  Property<double> window_{
      *this, "window", 0.2, {.live = true, .doc = "m; how far odometry may be wrong from scan to scan"}};
  Property<double> angle_window_{*this, "angle_window", 0.1, {.live = true, .doc = "rad; likewise"}};
  Property<double> sharpness_{
      *this, "sharpness", 0.1, {.doc = "m; a beam that ends this far from what is occupied counts half"}};
  Property<double> guess_weight_{
      *this, "guess_weight", 0.05, {.live = true, .doc = "how much odometry is preferred to a better match"}};
  Property<double> longest_beam_{
      *this, "longest_beam", 10.0, {.live = true, .doc = "m; longer ones are not used"}};
  Property<double> least_score_{
      *this, "least_score", 0.5, {.live = true, .doc = "from 0 to 1; worse matches are not believed"}};
  Property<std::uint64_t> most_cells_{*this, "most_cells", 1'000'000, {.doc = "of a map"}};
  Property<std::uint32_t> most_points_{*this, "most_points", 120, {.doc = "of a scan that are used"}};
  Operation<segue::Result<void>(Pose2D)> set_pose_{*this,
                                                   "set_pose",
                                                   {"pose"},
                                                   [this](const Pose2D& pose) { return set_pose(pose); },
                                                   RunsIn::TaskThread,
                                                   "tells where the vehicle is in the map"};

  std::optional<ClearanceMap> map_;
  std::optional<ScanMatcher> matcher_;
  PoseHistory history_;
  Pose2D correction_;  ///< the frame of the odometry in the map
  bool map_known_ = false;
  bool matched_ = false;
};

}  // namespace navigation

SEGUE_COMPONENT(navigation::Localization)
