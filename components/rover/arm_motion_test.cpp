// SPDX-License-Identifier: Apache-2.0
//
// How the simulated arm moves between its set points, at every step of the simulation.
#include "../manipulation/path_timing.hpp"
#include "../manipulation/trajectory.hpp"
#include "simulated_rover.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

namespace rover {
namespace {

using Angles = std::array<double, kArmJoints>;

/// As in the controllers of example 08.
std::vector<manipulation::JointLimits> limits_of_the_arm() {
  std::vector<manipulation::JointLimits> limits;
  for (const ArmJoint& joint : kArm)
    limits.push_back({joint.lowest, joint.highest, {.velocity = 1, .acceleration = 3, .jerk = 30}});
  return limits;
}

/// A rover that stands still, and the largest magnitudes of the true motion of its arm's joints: differences
/// of their velocities from each step of the simulation to the next one, without any filter.
class MeasuredArm {
 public:
  explicit MeasuredArm(int period) : period_(period) {
    auto made = SimulatedRover::create({.arm_period = period});
    EXPECT_TRUE(made) << to_string(made.error());
    rover_ = std::move(*made);
    rover_->command_gripper(kLargestOpening / 2);  // fingers at the end of their range shake the hand
    rover_->step(500);
    rover_->read_arm(state_);
  }

  [[nodiscard]] double period() const { return period_ * SimulatedRover::kStep; }
  [[nodiscard]] Angles positions() const { return numbers(state_.positions); }
  void follow(const Angles& set_points) {
    rover_->command_arm(set_points);
    for (int step = 0; step < period_; ++step) {
      const Angles before = numbers(state_.velocities);
      rover_->step(1);
      rover_->read_arm(state_);
      measure(before);
    }
  }
  /// Until the arm rests where its last set points are.
  void settle(const Angles& set_points) {
    for (int period = 0; period < 50; ++period)
      follow(set_points);
    for (std::size_t joint = 0; joint < kArmJoints; ++joint)
      EXPECT_NEAR(state_.positions[joint], set_points.at(joint), 1e-3) << "joint " << joint;
  }
  /// By 5 % at most are they exceeded, since the rover yields on its wheels.
  void expect_limits_kept() const {
    EXPECT_LT(velocity_, 1.05);
    EXPECT_LT(acceleration_, 1.05 * 3);
    EXPECT_LT(jerk_, 1.05 * 30);
    EXPECT_GT(velocity_, 0.9) << "the motion reaches its limit of velocity";
  }

 private:
  static Angles numbers(const std::vector<double>& values) {
    Angles angles{};
    std::copy_n(values.begin(), kArmJoints, angles.begin());
    return angles;
  }
  void measure(const Angles& before) {
    for (std::size_t joint = 0; joint < kArmJoints; ++joint) {
      const double now = state_.velocities[joint];
      const double acceleration = (now - before.at(joint)) / SimulatedRover::kStep;
      const double change = acceleration - accelerations_.at(joint);
      velocity_ = std::max(velocity_, std::abs(now));
      acceleration_ = std::max(acceleration_, std::abs(acceleration));
      jerk_ = std::max(jerk_, std::abs(change) / SimulatedRover::kStep);
      accelerations_.at(joint) = acceleration;
    }
  }

  int period_;
  std::unique_ptr<SimulatedRover> rover_;
  messages::JointState state_;
  Angles accelerations_{};
  double velocity_ = 0;
  double acceleration_ = 0;
  double jerk_ = 0;
};

/// The arm, moved by the trajectory generator to one configuration after the other; each is commanded after
/// some periods, where the arm has not arrived at the one before.
void move_by_generator(MeasuredArm& arm, const std::vector<Angles>& targets, int periods) {
  auto trajectory = manipulation::Trajectory::create(limits_of_the_arm());
  ASSERT_TRUE(trajectory);
  std::array<manipulation::JointMotion, kArmJoints> motions{};
  for (std::size_t joint = 0; joint < kArmJoints; ++joint)
    motions.at(joint).position = arm.positions().at(joint);
  trajectory->begin(motions);
  Angles set_points = arm.positions();
  const auto advance = [&] {
    trajectory->step(arm.period());
    for (std::size_t joint = 0; joint < kArmJoints; ++joint)
      set_points.at(joint) = trajectory->motion(joint).position;
    arm.follow(set_points);
  };
  for (const Angles& target : targets) {
    ASSERT_TRUE(trajectory->move_to(target));
    for (int period = 0; period < periods; ++period)
      advance();
  }
  while (!trajectory->at_rest())
    advance();
  arm.settle(set_points);
}

// Raised as in examples/08_rover, to both sides, and folded.
const std::vector<Angles> kConfigurations = {{0, -0.85, 2.42, 0, -1.57, 0},
                                             {0.9, -1.2, 1.8, 0.3, 0.4, 0.2},
                                             {-0.9, -1.2, 1.8, -0.3, 0.4, -0.2},
                                             kArmHome};

TEST(ArmMotion, KeepsTheLimitsOfAMotionThatIsNotInterrupted) {
  MeasuredArm arm(5);
  move_by_generator(arm, kConfigurations, 400);
  arm.expect_limits_kept();
}

TEST(ArmMotion, KeepsTheLimitsWhereEachMotionIsInterruptedByTheNext) {
  MeasuredArm arm(5);
  for (const int periods : {33, 61, 97})
    move_by_generator(arm, kConfigurations, periods);
  arm.expect_limits_kept();
}

TEST(ArmMotion, KeepsTheLimitsWhateverThePeriodOfTheSetPoints) {
  for (const int period : {1, 10}) {
    SCOPED_TRACE(period);
    MeasuredArm arm(period);
    move_by_generator(arm, kConfigurations, 400);
    arm.expect_limits_kept();
  }
}

TEST(ArmMotion, KeepsTheLimitsOnAPathWithCorners) {
  MeasuredArm arm(5);
  std::vector<std::vector<double>> points;
  for (const Angles& angles :
       {arm.positions(), Angles{0, -0.6, 0.8, 0.5, 0.3, -1}, Angles{0.8, -1.2, 1.6, 0, 0.6, 1}})
    points.emplace_back(angles.begin(), angles.end());
  const auto timing = manipulation::PathTiming::make(points, limits_of_the_arm(), {});
  ASSERT_TRUE(timing) << to_string(timing.error());
  Angles set_points{};
  for (double time = 0; time < timing->duration() + arm.period(); time += arm.period()) {
    timing->at(time, set_points);
    arm.follow(set_points);
  }
  arm.settle(set_points);
  arm.expect_limits_kept();
}

TEST(ArmMotion, IsTwoPeriodsBehindItsSetPoints) {
  MeasuredArm arm(5);
  Angles set_points = arm.positions();
  for (int period = 0; period < 200; ++period) {
    set_points[0] += 0.5 * arm.period();
    arm.follow(set_points);
  }
  // It is where the set point before the last one is, which came two periods ago.
  EXPECT_NEAR(arm.positions()[0], set_points[0] - 0.5 * arm.period(), 1e-4);
}

}  // namespace
}  // namespace rover
