// SPDX-License-Identifier: Apache-2.0
#include "trajectory.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace manipulation {
namespace {

rc::Gen<double> between(double low, double high) {
  return rc::gen::map(rc::gen::inRange(0, 1'000'001),
                      [=](int share) { return low + (high - low) * share / 1e6; });
}

MotionLimits some_limits() {
  return {*between(0.2, 3), *between(0.2, 10), *between(1, 100)};
}

/// Within the limits, and so that it can remain within them.
JointMotion some_motion(const MotionLimits& limits) {
  JointMotion motion{*between(-3, 3), *between(-1, 1) * limits.velocity,
                     *between(-1, 1) * limits.acceleration};
  if (std::abs(settled_velocity(motion, limits.jerk)) > limits.velocity) motion.acceleration = 0;
  return motion;
}

/// Whether jerk and acceleration keep their limits, and the velocity stays below `fastest`.
void check_limits(const JointProfile& profile, const MotionLimits& limits, double fastest) {
  constexpr double kRounding = 1e-6;
  const double step = profile.duration() / 1000;
  JointMotion last = profile.at(0);
  for (int i = 1; i <= 1010; ++i) {
    const JointMotion now = profile.at(i * step);
    RC_ASSERT(std::abs(now.velocity) <= fastest + kRounding);
    RC_ASSERT(std::abs(now.acceleration) <= limits.acceleration + kRounding);
    RC_ASSERT(std::abs(now.acceleration - last.acceleration) <= limits.jerk * step + kRounding);
    // Velocity and position are integrals of the acceleration: no part begins elsewhere than the last one
    // ended.
    RC_ASSERT(std::abs(now.velocity - last.velocity - step * last.acceleration) <=
              limits.jerk * step * step + kRounding);
    RC_ASSERT(std::abs(now.position - last.position - step * last.velocity) <=
              limits.acceleration * step * step + kRounding);
    last = now;
  }
}

RC_GTEST_PROP(JointProfile, ReachesAnyPositionWithinAllLimits, ()) {
  const MotionLimits limits = some_limits();
  const JointMotion start = some_motion(limits);
  const double target = *between(-3, 3);
  const auto profile = JointProfile::to_position(start, target, limits);
  const JointMotion end = profile.at(profile.duration());
  RC_ASSERT(std::abs(end.position - target) < 1e-6);
  RC_ASSERT(std::abs(end.velocity) < 1e-6);
  RC_ASSERT(std::abs(end.acceleration) < 1e-6);
  check_limits(profile, limits, limits.velocity);
  const JointMotion later = profile.at(profile.duration() + 100);
  RC_ASSERT(std::abs(later.position - target) < 1e-4);
}

RC_GTEST_PROP(JointProfile, TakesAnyLongerTime, ()) {
  const MotionLimits limits = some_limits();
  const JointMotion start = some_motion(limits);
  const double target = *between(-3, 3);
  const double shortest = JointProfile::to_position(start, target, limits).duration();
  const double wanted = shortest * *between(1, 5);
  const auto profile = JointProfile::to_position_within(start, target, limits, wanted);
  RC_ASSERT(std::abs(profile.at(wanted).position - target) < 1e-6);
  RC_ASSERT(std::abs(profile.at(wanted).velocity) < 1e-6);
  check_limits(profile, limits, limits.velocity);
}

RC_GTEST_PROP(JointProfile, TakesOnAnyVelocityWithinAllLimits, ()) {
  const MotionLimits limits = some_limits();
  const JointMotion start = some_motion(limits);
  const double target = *between(-1, 1) * limits.velocity;
  const auto profile = JointProfile::to_velocity(start, target, limits);
  const JointMotion end = profile.at(profile.duration() + 1);
  RC_ASSERT(std::abs(end.velocity - target) < 1e-6);
  RC_ASSERT(std::abs(end.acceleration) < 1e-6);
  check_limits(profile, limits, limits.velocity);
}

RC_GTEST_PROP(JointProfile, BringsBackWhatExceedsTheLimits, ()) {
  const MotionLimits limits = some_limits();
  const JointMotion start{*between(-3, 3), *between(-2, 2) * limits.velocity,
                          *between(-2, 2) * limits.acceleration};
  const double target = *between(-3, 3);
  const auto profile = JointProfile::to_position(start, target, limits);
  RC_ASSERT(std::abs(profile.at(profile.duration()).position - target) < 1e-5);
  const double unavoidable =
      std::max(std::abs(start.velocity), std::abs(settled_velocity(start, limits.jerk)));
  bool back = false;
  double acceleration = std::abs(start.acceleration);
  for (int i = 0; i <= 1000; ++i) {
    const JointMotion now = profile.at(profile.duration() * i / 1000);
    RC_ASSERT(std::abs(now.velocity) <= std::max(limits.velocity, unavoidable) + 1e-6);
    RC_ASSERT(std::abs(now.acceleration) <= std::max(limits.acceleration, acceleration) + 1e-6);
    acceleration = std::abs(now.acceleration);
    const bool within = std::abs(now.velocity) <= limits.velocity + 1e-6 &&
                        std::abs(settled_velocity(now, limits.jerk)) <= limits.velocity + 1e-6;
    RC_ASSERT(within || !back);
    back = within;
  }
  RC_ASSERT(back);
}

TEST(JointProfile, FromRestToRestItIsTheShortest) {
  // Seven parts: 1 rad/s is reached in 0.5 s with 0.1 s of jerk at either end of the acceleration.
  const MotionLimits limits{1, 2.5, 25};
  const auto profile = JointProfile::to_position({}, 2, limits);
  EXPECT_NEAR(profile.duration(), 2.0 / 1 + 1 / 2.5 + 2.5 / 25, 1e-9);
  // Short ways: four parts of jerk.
  const auto little = JointProfile::to_position({}, 2 * 25 * std::pow(0.05, 3), limits);
  EXPECT_NEAR(little.duration(), 0.2, 1e-6);
}

std::vector<JointLimits> some_joints() {
  std::vector<JointLimits> joints(*rc::gen::inRange<std::size_t>(1, 8));
  for (JointLimits& joint : joints) {
    joint.motion = some_limits();
    joint.lower = *between(-3, -0.5);
    joint.upper = *between(0.5, 3);
  }
  return joints;
}

/// A motion from which the joint can stop within its range.
JointMotion some_motion_of(const JointLimits& joint) {
  JointMotion motion = some_motion(joint.motion);
  motion.position = *between(joint.lower, joint.upper);
  const auto stop = JointProfile::to_velocity(motion, 0, joint.motion);
  constexpr double kMargin = 1e-3;  // for what lies between the samples
  for (int i = 0; i <= 200; ++i) {
    const double position = stop.at(stop.duration() * i / 200).position;
    if (position < joint.lower + kMargin || position > joint.upper - kMargin) return {motion.position, 0, 0};
  }
  return motion;
}

RC_GTEST_PROP(Trajectory, KeepsAllLimitsWhateverIsCommandedAndWhen, ()) {
  constexpr double kRounding = 1e-6;
  const auto joints = some_joints();
  auto trajectory = Trajectory::create(joints);
  RC_ASSERT(trajectory);
  std::vector<JointMotion> last;
  for (const JointLimits& joint : joints)
    last.push_back(some_motion_of(joint));
  trajectory->begin(last);
  const int steps = *rc::gen::inRange(1, 150);
  for (int i = 0; i < steps; ++i) {
    std::vector<double> command;
    const int choice = *rc::gen::inRange(0, 12);
    for (const JointLimits& joint : joints)
      command.push_back(choice == 1 ? *between(-4, 4) : *between(-1.5, 1.5) * joint.motion.velocity);
    if (choice == 0) trajectory->stop();
    if (choice == 1) RC_ASSERT(trajectory->move_to(command));
    if (choice == 2 || choice == 3) RC_ASSERT(trajectory->move_with(command));
    const double step = *between(0.0005, 0.05);
    trajectory->step(step);
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const JointMotion& now = trajectory->motion(j);
      const MotionLimits& limits = joints[j].motion;
      RC_ASSERT(std::abs(now.velocity) <= limits.velocity + kRounding);
      RC_ASSERT(std::abs(now.acceleration) <= limits.acceleration + kRounding);
      RC_ASSERT(std::abs(now.acceleration - last[j].acceleration) <= limits.jerk * step + kRounding);
      RC_ASSERT(now.position >= joints[j].lower - kRounding);
      RC_ASSERT(now.position <= joints[j].upper + kRounding);
      RC_ASSERT(std::abs(now.position - last[j].position) <= limits.velocity * step + kRounding);
      last[j] = now;
    }
  }
}

RC_GTEST_PROP(Trajectory, AllJointsArriveTogether, ()) {
  const auto joints = some_joints();
  auto trajectory = Trajectory::create(joints);
  std::vector<JointMotion> start;
  std::vector<double> target;
  double longest = 0;
  for (const JointLimits& joint : joints) {
    start.push_back(some_motion_of(joint));
    target.push_back(*between(joint.lower, joint.upper));
    longest =
        std::max(longest, JointProfile::to_position(start.back(), target.back(), joint.motion).duration());
  }
  trajectory->begin(start);
  RC_ASSERT(trajectory->move_to(target));
  trajectory->step(longest + 1e-3);
  const auto farthest = [&] {
    double error = 0;
    for (std::size_t j = 0; j < joints.size(); ++j)
      error = std::max(error, std::abs(trajectory->motion(j).position - target[j]));
    return error;
  };
  RC_ASSERT(farthest() < 1e-6);
  RC_ASSERT(trajectory->at_rest());
  trajectory->step(1000);
  RC_ASSERT(farthest() < 1e-4);
}

TEST(Trajectory, AVelocityEndsWhereTheRangeEnds) {
  auto trajectory = Trajectory::create(std::vector<JointLimits>{{-1, 2, {1, 5, 50}}});
  trajectory->begin(std::vector<JointMotion>{{}});
  ASSERT_TRUE(trajectory->move_with(std::vector<double>{0.5}));
  trajectory->step(2);
  EXPECT_NEAR(trajectory->motion(0).velocity, 0.5, 1e-9);
  trajectory->step(10);
  EXPECT_NEAR(trajectory->motion(0).position, 2, 1e-6);
  EXPECT_TRUE(trajectory->at_rest());
  ASSERT_TRUE(trajectory->move_with(std::vector<double>{-9}));
  trajectory->step(1);
  EXPECT_NEAR(trajectory->motion(0).velocity, -1, 1e-9) << "limited";
}

TEST(Trajectory, EndlessJointsKeepTurning) {
  const double endless = std::numeric_limits<double>::infinity();
  auto trajectory = Trajectory::create(std::vector<JointLimits>{{-endless, endless, {1, 5, 50}}});
  trajectory->begin(std::vector<JointMotion>{{}});
  ASSERT_TRUE(trajectory->move_with(std::vector<double>{1}));
  trajectory->step(1000);
  EXPECT_GT(trajectory->motion(0).position, 990);
}

TEST(Trajectory, RefusesWhatItCannotFollow) {
  EXPECT_FALSE(Trajectory::create({}));
  EXPECT_FALSE(Trajectory::create(std::vector<JointLimits>(17)));
  EXPECT_FALSE(Trajectory::create(std::vector<JointLimits>{{1, -1, {}}}));
  EXPECT_FALSE(Trajectory::create(std::vector<JointLimits>{{-1, 1, {0, 1, 1}}}));
  auto trajectory = Trajectory::create(std::vector<JointLimits>(2));
  ASSERT_TRUE(trajectory);
  EXPECT_FALSE(trajectory->move_to(std::vector<double>{1}));
  EXPECT_FALSE(trajectory->move_with(std::vector<double>{1, std::nan("")}));
  trajectory->step(1);
  EXPECT_TRUE(trajectory->at_rest());
}

}  // namespace
}  // namespace manipulation
