// SPDX-License-Identifier: Apache-2.0
#include "pose_servo.hpp"

#include <segue/task/component.hpp>

#include <chrono>
#include <optional>

namespace manipulation {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Brings the tip of an arm to a pose and keeps it there.
class CartesianController final : public Component {
 public:
  CartesianController()
      : Component({.doc = "Commands velocities of the tip that lead to a pose and keep it there",
                   .activity = segue::periodic(std::chrono::milliseconds(10))}) {}

 private:
  segue::Result<void> on_configure() override {
    if (!(*gain_ > 0) || !(*speed_ > 0) || !(*turn_rate_ > 0) || !is_usable(*offset_)) {
      return segue::fail(segue::ErrorCode::InvalidArgument,
                         "gain, speed and turn_rate must be positive, and offset a pose of finite numbers");
    }
    return {};
  }

  segue::Result<void> on_start() override {
    target_.reset();
    pose_time_.reset();
    reached_ = false;
    return {};
  }

  void on_update() override {
    messages::Pose pose;
    if (pose_in_.read(pose) == ReadStatus::NewData && is_usable(pose)) {
      pose_ = pose;
      pose_time_ = now();
    }
    messages::Pose target;
    if (target_in_.read(target) == ReadStatus::NewData && is_usable(target)) target_ = target;
    if (!pose_time_ || now() - *pose_time_ > *timeout_) {
      waiting_.enter();
      twist_out_.write({});
    } else if (!target_) {
      idle_.enter();
      twist_out_.write({});
    } else {
      servo();
    }
  }

  void on_stop() override { twist_out_.write({}); }

  void servo() {
    Pose goal = *target_;
    goal.orientation.normalize();
    const PoseError error = error_between(pose_, compose(goal, *offset_));
    const double distance = error.translation.norm();
    const double angle = error.rotation.norm();
    // A target that has been reached stays so while the tool swings a little.
    const double slack = reached_ ? 2 : 1;
    reached_ = distance <= slack * *tolerance_ && angle <= slack * *angle_tolerance_;
    (reached_ ? reached_state_ : reaching_).enter();
    twist_out_.write(velocity_towards(error, {*gain_, *speed_, *turn_rate_}));
    distance_out_.write(distance);
  }

  segue::Result<void> set_target(const Pose& target) {
    if (!is_usable(target)) {
      return segue::fail(
          segue::ErrorCode::InvalidArgument,
          "the target must consist of finite numbers and have an orientation that is not zero");
    }
    target_ = target;
    reached_ = false;
    return {};
  }

  State waiting_{*this, "waiting"};
  State idle_{*this, "idle"};
  State reaching_{*this, "reaching"};
  State reached_state_{*this, "reached"};
  InputPort<messages::Pose> pose_in_{*this, "pose", {.doc = "of the tip in the frame of the base"}};
  InputPort<messages::Pose> target_in_{*this, "target", {.doc = "likewise; replaces that of set_target"}};
  OutputPort<messages::Twist> twist_out_{*this, "twist", {.doc = "of the tip, in the frame of the base"}};
  OutputPort<double> distance_out_{*this, "distance", {.doc = "m to the target"}};
  Property<messages::Pose> offset_{
      *this, "offset", {}, {.doc = "where the tip shall be, in the frame of the target"}};
  Property<double> gain_{*this, "gain", 2.0, {.doc = "1/s; velocity per distance"}};
  Property<double> speed_{*this, "speed", 0.25, {.doc = "m/s; maximum"}};
  Property<double> turn_rate_{*this, "turn_rate", 1.0, {.doc = "rad/s; maximum"}};
  Property<double> tolerance_{
      *this, "tolerance", 0.005, {.live = true, .doc = "m; distance at which the target counts as reached"}};
  Property<double> angle_tolerance_{*this, "angle_tolerance", 0.02, {.live = true, .doc = "rad; likewise"}};
  Property<std::chrono::milliseconds> timeout_{
      *this,
      "timeout",
      std::chrono::milliseconds(200),
      {.live = true, .doc = "waits where the pose is older than this"}};
  Operation<segue::Result<void>(messages::Pose)> set_target_{
      *this,
      "set_target",
      {"target"},
      [this](const Pose& target) { return set_target(target); },
      RunsIn::TaskThread,
      "moves the tip to this pose in the frame of the base"};
  Operation<void()> clear_target_{*this,
                                  "clear_target",
                                  {},
                                  [this] { target_.reset(); },
                                  RunsIn::TaskThread,
                                  "lets the tip rest where it is"};

  Pose pose_;
  std::optional<Pose> target_;
  std::optional<segue::TimePoint> pose_time_;
  bool reached_ = false;
};

}  // namespace manipulation

SEGUE_COMPONENT(manipulation::CartesianController)
