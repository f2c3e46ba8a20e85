// SPDX-License-Identifier: Apache-2.0
#include "arm_kinematics.hpp"
#include "joint_input.hpp"

#include <segue/task/component.hpp>

#include <chrono>
#include <optional>

namespace manipulation {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Tells where the tip of an arm is.
class ForwardKinematics final : public Component {
 public:
  ForwardKinematics()
      : Component({.doc = "Computes the pose of the tip of an arm from the positions of its joints"}) {}

 private:
  segue::Result<void> on_configure() override {
    auto made = ArmKinematics::create(*joint_list_, *tool_);
    if (!made) return std::move(made.error());
    kinematics_.emplace(std::move(*made));
    return {};
  }
  segue::Result<void> on_start() override {
    joints_.begin(kinematics_->size());
    return {};
  }
  void on_update() override {
    if (!joints_.read(now(), std::chrono::hours(1))) return;
    const messages::Pose tip = kinematics_->tip(joints_.positions());
    pose_out_.write(tip);
    timed_pose_out_.write({joints_.time(), tip});
  }
  void on_cleanup() override { kinematics_.reset(); }

  JointInput joints_{*this};
  OutputPort<messages::Pose> pose_out_{*this, "pose", {.doc = "of the tip in the frame of the base"}};
  OutputPort<messages::TimedPose> timed_pose_out_{
      *this, "timed_pose", {.doc = "likewise, with the time of the joints' positions"}};
  Property<std::vector<JointDescription>> joint_list_{
      *this, "joint_list", {}, {.doc = "from the base to the tip"}};
  Property<messages::Pose> tool_{*this, "tool", {}, {.doc = "pose of the tip on the last link"}};

  std::optional<ArmKinematics> kinematics_;
};

}  // namespace manipulation

SEGUE_COMPONENT(manipulation::ForwardKinematics)
