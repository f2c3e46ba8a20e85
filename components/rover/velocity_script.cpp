// SPDX-License-Identifier: Apache-2.0
#include "../messages/geometry.hpp"
#include "types.hpp"

#include <segue/task/component.hpp>

#include <vector>

namespace rover {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Commands velocities one after the other, for as long as each shall last by the robot's clock.
class VelocityScript final : public Component {
 public:
  VelocityScript()
      : Component({.doc = "Commands velocities one after the other, then to stand still",
                   .trigger_on = {"time"}}) {}

 protected:
  segue::Result<void> on_configure() override {
    for (const Leg& leg : *legs_) {
      if (leg.duration > 0) continue;
      return segue::fail(segue::ErrorCode::InvalidArgument, "the duration of each leg must be positive");
    }
    return {};
  }

  segue::Result<void> on_start() override {
    leg_ = 0;
    begun_ = false;
    return {};
  }

  void on_update() override {
    double time = 0;
    if (time_in_.read(time) == ReadStatus::NoData) return;
    if (!begun_) leg_end_ = time + (legs_->empty() ? 0 : legs_->front().duration);
    begun_ = true;
    while (leg_ < legs_->size() && time >= leg_end_) {
      ++leg_;
      if (leg_ < legs_->size()) leg_end_ += (*legs_)[leg_].duration;
    }
    const bool finished = leg_ == legs_->size();
    (finished ? finished_ : driving_).enter();
    command_out_.write(finished ? messages::Twist2D{}
                                : messages::Twist2D{(*legs_)[leg_].linear, (*legs_)[leg_].angular});
  }

 private:
  State driving_{*this, "driving"};
  State finished_{*this, "finished"};
  InputPort<double> time_in_{*this, "time", {.doc = "the robot's clock, s"}};
  OutputPort<messages::Twist2D> command_out_{*this, "command", {.doc = "wanted velocity"}};
  Property<std::vector<Leg>> legs_{
      *this, "legs", {{2.5, 0.3, 0.0}}, {.doc = "what to command, and for how long"}};
  bool begun_ = false;
  std::size_t leg_ = 0;
  double leg_end_ = 0;
};

}  // namespace rover

SEGUE_COMPONENT(rover::VelocityScript)
