// SPDX-License-Identifier: Apache-2.0
#include "pose_filter.hpp"
#include "timed_poses.hpp"

#include "../messages/sensors.hpp"

#include <segue/task/component.hpp>

#include <algorithm>
#include <chrono>
#include <optional>

namespace manipulation {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Tells where an object with a marker is, from what a camera on the arm sees.
class MarkerTracker final : public Component {
 public:
  MarkerTracker()
      : Component(
            {.doc =
                 "Finds the pose of a marked object in the frame of the arm's base, with a camera on the arm",
             .activity = segue::periodic(std::chrono::milliseconds(20))}) {}

 private:
  segue::Result<void> on_configure() override {
    if (!is_usable(*camera_) || !is_usable(*object_)) {
      return segue::fail(segue::ErrorCode::InvalidArgument,
                         "camera and object must be poses of finite numbers");
    }
    return {};
  }

  segue::Result<void> on_start() override {
    filter_.reset();
    seen_.reset();
    tips_.clear();
    return {};
  }

  void on_update() override {
    messages::TimedPose tip;
    while (tip_in_.read(tip) == ReadStatus::NewData)
      tips_.add(tip);
    while (const auto markers = markers_in_.take()) {
      const auto marker = std::ranges::find(markers->markers, *marker_id_, &messages::Marker::id);
      if (marker == markers->markers.end() || !is_usable(marker->pose)) continue;
      const auto at_that_time = tip_in_.connected() ? tips_.at(markers->time) : Pose{};
      if (at_that_time) take(*at_that_time, marker->pose);
    }
    const bool tracking = seen_ && now() - *seen_ <= *lost_after_;
    if (!tracking) filter_.reset();
    (tracking ? tracking_ : lost_).enter();
  }

  void take(const Pose& tip, const Pose& marker) {
    const Pose measured = compose(compose(compose(tip, *camera_), marker), *object_);
    const double elapsed = seen_ ? std::chrono::duration<double>(now() - *seen_).count() : 0;
    if (!filter_.add(measured, elapsed, {*time_constant_, *largest_jump_, *confirmations_})) return;
    seen_ = now();
    object_out_.write(*filter_.estimate());
  }

  State tracking_{*this, "tracking"};
  State lost_{*this, "lost"};
  InputPort<messages::Markers> markers_in_{*this, "markers"};
  InputPort<messages::TimedPose> tip_in_{
      *this,
      "tip",
      {.doc = "of the arm, on which the camera is mounted; not connected: it is fixed to the base"}};
  OutputPort<messages::Pose> object_out_{
      *this, "object", {.doc = "in the frame of the base; while it is seen"}};
  Property<std::int32_t> marker_id_{*this, "marker_id", 0, {.live = true, .doc = "the marker to be tracked"}};
  Property<messages::Pose> camera_{
      *this, "camera", {}, {.doc = "pose of the camera in the frame of the tip, or of the base"}};
  Property<messages::Pose> object_{
      *this, "object_pose", {}, {.doc = "of the object in the frame of the marker"}};
  Property<double> time_constant_{
      *this, "time_constant", 0.2, {.live = true, .doc = "s; how slowly the estimate follows"}};
  Property<double> largest_jump_{
      *this, "largest_jump", 0.1, {.live = true, .doc = "m; a pose that is farther away is doubted"}};
  Property<std::int32_t> confirmations_{
      *this, "confirmations", 5, {.live = true, .doc = "doubted poses in a row that are believed"}};
  Property<std::chrono::milliseconds> lost_after_{
      *this, "lost_after", std::chrono::milliseconds(500), {.live = true, .doc = "without the marker"}};

  PoseFilter filter_;
  TimedPoses tips_;
  std::optional<segue::TimePoint> seen_;
};

}  // namespace manipulation

SEGUE_COMPONENT(manipulation::MarkerTracker)
