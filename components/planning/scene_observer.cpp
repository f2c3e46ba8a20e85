// SPDX-License-Identifier: Apache-2.0
#include "arm_scene.hpp"
#include "box_estimate.hpp"

#include "../messages/sensors.hpp"

#include <segue/task/component.hpp>

#include <chrono>
#include <optional>

namespace planning {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Tells what plans begin with: where the arm and the boxes are. Allocates with each image.
class SceneObserver final : public Component {
 public:
  SceneObserver()
      : Component(
            {.doc = "Finds out where the arm and the boxes are, with a camera that is fixed to the rover",
             .trigger_on = {"markers"}}) {}

 private:
  segue::Result<void> on_configure() override {
    if (*images_ < 1 || *images_ > 100) {
      return segue::fail(segue::ErrorCode::InvalidArgument, "images must be from 1 to 100");
    }
    camera_frame_ = frame_of(*camera_);
    box_frame_ = frame_of(*object_);
    return {};
  }

  segue::Result<void> on_start() override {
    estimate_.emplace(*images_);
    return {};
  }

  void on_update() override {
    const auto joints = joints_in_.latest();
    const auto markers = markers_in_.take();
    if (!markers) return;
    estimate_->next_image();
    for (const messages::Marker& marker : markers->markers)
      estimate_->add(marker.id, pose_of(camera_frame_ * frame_of(marker.pose) * box_frame_));
    Situation situation{.base = *base_, .positions = {}, .boxes = {}, .held = -1, .grasp = {}};
    for (const std::int32_t id : *ids_) {
      if (const auto pose = estimate_->pose(id)) situation.boxes.push_back({id, *pose});
    }
    if (joints) situation.positions = joints->positions;
    const bool complete = joints && situation.boxes.size() == ids_->size();
    (complete ? complete_ : looking_).enter();
    if (complete) situation_out_.write(situation);
  }

  State looking_{*this, "looking"};
  State complete_{*this, "complete"};
  InputPort<messages::Markers> markers_in_{*this, "markers", {.doc = "what the camera sees"}};
  InputPort<messages::JointState> joints_in_{*this, "joints", {.doc = "of the arm"}};
  OutputPort<Situation> situation_out_{
      *this, "situation", {.doc = "once all boxes have been seen often enough"}};
  Property<std::vector<std::int32_t>> ids_{*this, "ids", {}, {.doc = "markers of the boxes to be found"}};
  Property<std::uint32_t> images_{*this, "images", 5, {.doc = "on which each box has to be seen"}};
  Property<messages::Pose> camera_{
      *this, "camera", {}, {.doc = "pose of the camera in the frame of the rover"}};
  Property<messages::Pose> object_{
      *this, "object_pose", {}, {.doc = "of the centre of a box in the frame of its marker"}};
  Property<messages::Pose2D> base_{
      *this, "base", {}, {.doc = "where the rover stands, in the frame of the room"}};

  Eigen::Isometry3d camera_frame_ = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d box_frame_ = Eigen::Isometry3d::Identity();
  std::optional<BoxEstimate> estimate_;
};

}  // namespace planning

SEGUE_COMPONENT(planning::SceneObserver)
