// SPDX-License-Identifier: Apache-2.0
#include "path_tracker.hpp"
#include "types.hpp"

#include <segue/task/component.hpp>

#include <algorithm>
#include <chrono>
#include <optional>

namespace navigation {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Drives along paths and stops in front of obstacles.
class PathFollower final : public Component {
 public:
  PathFollower()
      : Component(
            {.doc = "Follows paths within limits of speed and acceleration, and stops in front of obstacles",
             .activity = segue::periodic(std::chrono::milliseconds(50))}) {}

 private:
  segue::Result<void> on_configure() override {
    const bool positive = std::ranges::all_of(
        std::initializer_list<double>{*speed_, *turn_rate_, *acceleration_, *deceleration_,
                                      *angular_acceleration_, *lookahead_, *tolerance_, *angle_tolerance_},
        [](double value) { return value > 0; });
    if (!positive || *most_poses_ < 1 || *most_points_ < 1) {
      return segue::fail(segue::ErrorCode::InvalidArgument,
                         "limits, lookahead, tolerances, most_poses and most_points must be positive");
    }
    tracker_.emplace(*most_poses_);
    obstacles_.emplace(*most_points_);
    return {};
  }

  segue::Result<void> on_start() override {
    tracker_->reset();
    progress_ = {};
    last_update_ = now();
    pose_time_.reset();
    scan_time_.reset();
    return {};
  }

  void on_update() override {
    const double step = std::chrono::duration<double>(now() - last_update_).count();
    last_update_ = now();
    if (const auto path = path_in_.take()) {
      progress_.goal = path->goal;
      if (!tracker_->set_path(path->poses))
        log(segue::LogLevel::Error, "the path has more than most_poses poses: increase that property");
    }
    if (pose_in_.read(pose_) == ReadStatus::NewData) pose_time_ = now();
    if (const auto scan = scan_in_.take()) {
      obstacles_->set(*scan, *sensor_);
      scan_time_ = now();
    }
    if (step <= 0) return;
    const TrackerSettings settings = current_settings();
    if (late(pose_time_) || (*use_scan_ && late(scan_time_))) {
      waiting_.enter();
      command_out_.write(tracker_->brake(settings, step));
      return;
    }
    if (!*use_scan_) obstacles_->clear();
    command_out_.write(tracker_->update(pose_.pose, obstacles_->points(), settings, step));
    progress_.remaining = tracker_->remaining();
    progress_.arrived = tracker_->state() == TrackerState::Arrived;
    progress_out_.write(progress_);
    state_of(tracker_->state()).enter();
  }

  void on_stop() override { command_out_.write({}); }

  [[nodiscard]] bool late(const std::optional<segue::TimePoint>& time) const {
    return !time || now() - *time > *timeout_;
  }
  [[nodiscard]] TrackerSettings current_settings() const {
    return {{*speed_, *turn_rate_, *acceleration_, *deceleration_, *angular_acceleration_},
            *radius_,
            *stop_distance_,
            *lookahead_,
            *turn_on_spot_,
            *tolerance_,
            *angle_tolerance_,
            *final_heading_};
  }
  [[nodiscard]] const State& state_of(TrackerState state) const {
    switch (state) {
      case TrackerState::Idle:
        return idle_;
      case TrackerState::Driving:
        return driving_;
      case TrackerState::Arrived:
        return arrived_;
      case TrackerState::Blocked:
        return blocked_;
    }
    return idle_;
  }

  State idle_{*this, "idle"};
  State waiting_{*this, "waiting"};
  State driving_{*this, "driving"};
  State arrived_{*this, "arrived"};
  State blocked_{*this, "blocked"};
  InputPort<messages::Path> path_in_{*this, "path", {.doc = "an empty one ends the drive"}};
  InputPort<messages::Odometry> pose_in_{*this, "pose", {.doc = "of the vehicle in the frame of the path"}};
  InputPort<messages::LaserScan> scan_in_{*this, "scan"};
  OutputPort<messages::Twist2D> command_out_{*this, "command"};
  OutputPort<DriveProgress> progress_out_{*this, "progress", {.doc = "while it knows pose and obstacles"}};
  Property<double> speed_{*this, "speed", 0.5, {.doc = "m/s; maximum"}};
  Property<double> turn_rate_{*this, "turn_rate", 1.2, {.doc = "rad/s; maximum"}};
  Property<double> acceleration_{*this, "acceleration", 0.5, {.doc = "m/s^2; maximum"}};
  Property<double> deceleration_{*this, "deceleration", 1.0, {.doc = "m/s^2; maximum"}};
  Property<double> angular_acceleration_{*this, "angular_acceleration", 3.0, {.doc = "rad/s^2; maximum"}};
  Property<double> radius_{
      *this,
      "radius",
      0.25,
      {.doc = "m, of the circle around the vehicle; at least 0.05 less than the planner's"}};
  Property<double> stop_distance_{
      *this, "stop_distance", 0.05, {.live = true, .doc = "m; gap at which it stops in front of obstacles"}};
  Property<double> lookahead_{
      *this, "lookahead", 0.4, {.live = true, .doc = "m along the path to the point that is driven at"}};
  Property<double> turn_on_spot_{
      *this, "turn_on_spot", 0.9, {.live = true, .doc = "rad; from this angle on it turns before it drives"}};
  Property<double> tolerance_{
      *this, "tolerance", 0.08, {.live = true, .doc = "m; distance at which the goal counts as reached"}};
  Property<double> angle_tolerance_{*this, "angle_tolerance", 0.1, {.live = true, .doc = "rad; likewise"}};
  Property<bool> final_heading_{
      *this, "final_heading", true, {.live = true, .doc = "turn to the heading of the last pose"}};
  Property<bool> use_scan_{*this, "use_scan", true, {.live = true, .doc = "false: drive without looking"}};
  Property<Pose2D> sensor_{*this, "sensor", {}, {.live = true, .doc = "pose of the scanner on the vehicle"}};
  Property<std::chrono::milliseconds> timeout_{
      *this,
      "timeout",
      std::chrono::milliseconds(500),
      {.live = true, .doc = "waits where pose or scan are older than this"}};
  Property<std::uint32_t> most_poses_{*this, "most_poses", 256, {.doc = "of a path"}};
  Property<std::uint32_t> most_points_{*this, "most_points", 1024, {.doc = "of a scan that are looked at"}};

  std::optional<PathTracker> tracker_;
  std::optional<ObstaclePoints> obstacles_;
  messages::Odometry pose_;
  DriveProgress progress_;
  segue::TimePoint last_update_;
  std::optional<segue::TimePoint> pose_time_;
  std::optional<segue::TimePoint> scan_time_;
};

}  // namespace navigation

SEGUE_COMPONENT(navigation::PathFollower)
