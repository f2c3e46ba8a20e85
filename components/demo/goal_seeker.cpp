// SPDX-License-Identifier: Apache-2.0
#include "types.hpp"

#include <segue/task/component.hpp>

#include <algorithm>
#include <cmath>

namespace demo {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Drives straight to a goal.
class GoalSeeker final : public Component {
 public:
  GoalSeeker() : Component({.doc = "Commands velocities that lead to a goal", .trigger_on = {"pose"}}) {}

 protected:
  segue::Result<void> on_configure() override {
    target_ = *goal_;
    return {};
  }

  void on_update() override {
    const auto pose = pose_in_.latest();
    if (!pose) return;
    const double dx = target_.x - pose->x;
    const double dy = target_.y - pose->y;
    const double distance = std::hypot(dx, dy);
    const bool arrived = distance < *tolerance_;
    (arrived ? arrived_ : driving_).enter();
    distance_out_.write(distance);
    command_out_.write(arrived ? Velocity{} : towards(std::atan2(dy, dx) - pose->theta, distance));
  }

 private:
  /// `angle`: to the goal, from where it heads.
  Velocity towards(double angle, double distance) const {
    const double error = std::remainder(angle, 2 * M_PI);
    const double forward = std::min(*speed_, distance) * std::max(0.0, std::cos(error));
    return {forward, 2.0 * error};
  }

  State driving_{*this, "driving"};
  State arrived_{*this, "arrived"};
  InputPort<Pose> pose_in_{*this, "pose"};
  OutputPort<Velocity> command_out_{*this, "command"};
  OutputPort<double> distance_out_{*this, "distance", {.doc = "m to the goal"}};
  Property<Point> goal_{*this, "goal", {3.0, -2.0}, {.doc = "goal position"}};
  Property<double> speed_{*this, "speed", 0.6, {.live = true, .doc = "m/s; maximum"}};
  Property<double> tolerance_{
      *this, "tolerance", 0.1, {.live = true, .doc = "m; distance at which the goal counts as reached"}};
  Operation<void(Point)> set_goal_{*this,
                                   "set_goal",
                                   {"goal"},
                                   [this](Point goal) { target_ = goal; },
                                   RunsIn::TaskThread,
                                   "sets another goal, until the task is configured again"};
  Point target_;
};

}  // namespace demo

SEGUE_COMPONENT(demo::GoalSeeker)
