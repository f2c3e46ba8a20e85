// SPDX-License-Identifier: Apache-2.0
#include "types.hpp"

#include <segue/task/component.hpp>

#include <chrono>
#include <cmath>

namespace demo {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Estimates the pose of the robot by integrating its velocity.
class Odometry final : public Component {
 public:
  Odometry()
      : Component({.doc = "Integrates velocities to a pose",
                   .activity = segue::periodic(std::chrono::milliseconds(20))}) {}

 protected:
  segue::Result<void> on_configure() override {
    pose_ = *start_;
    return {};
  }

  segue::Result<void> on_start() override {
    last_ = now();
    return {};
  }

  void on_update() override {
    const double step = std::chrono::duration<double>(now() - last_).count();
    last_ = now();
    velocity_in_.read(velocity_);
    const double middle = pose_.theta + 0.5 * step * velocity_.turn;
    pose_.x += step * velocity_.forward * std::cos(middle);
    pose_.y += step * velocity_.forward * std::sin(middle);
    pose_.theta = std::remainder(pose_.theta + step * velocity_.turn, 2 * M_PI);
    pose_out_.write(pose_);
  }

 private:
  void reset() {
    pose_ = *start_;
    log(segue::LogLevel::Info, "the pose was reset");
  }

  InputPort<Velocity> velocity_in_{*this, "velocity", {.doc = "velocity of the robot"}};
  OutputPort<Pose> pose_out_{*this, "pose", {.doc = "where it is now"}};
  Property<Pose> start_{*this, "start", {}, {.doc = "pose after configure"}};
  Operation<void()> reset_{
      *this, "reset", {}, [this] { reset(); }, RunsIn::TaskThread, "sets the pose back to the start"};
  Pose pose_;
  Velocity velocity_;
  segue::TimePoint last_;
};

}  // namespace demo

SEGUE_COMPONENT(demo::Odometry)
