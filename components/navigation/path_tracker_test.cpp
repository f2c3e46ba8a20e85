// SPDX-License-Identifier: Apache-2.0
#include "path_tracker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace navigation {
namespace {

constexpr double kStep = 0.05;  // s

/// Drives until the tracker is in `until` or `limit` seconds have passed.
struct Drive {
  PathTracker tracker{100};
  TrackerSettings settings;
  Pose2D pose;
  std::vector<Point> obstacles;  ///< in the frame of the path
  double farthest_off = 0;       ///< from the x axis

  TrackerState run(TrackerState until, double limit) {
    for (double time = 0; time < limit; time += kStep) {
      std::vector<Point> seen;
      for (const Point& point : obstacles) {
        const Pose2D local = compose(inverse(pose), {point.x, point.y, 0});
        seen.push_back({local.x, local.y});
      }
      pose = moved(pose, tracker.update(pose, seen, settings, kStep), kStep);
      farthest_off = std::max(farthest_off, std::abs(pose.y));
      if (tracker.state() == until) break;
    }
    return tracker.state();
  }
};

TEST(PathTracker, ArrivesAtTheEndWithItsHeading) {
  Drive drive;
  ASSERT_TRUE(drive.tracker.set_path({{0, 0, 0}, {2, 0, 0}, {2, 2, 2.5}}));
  EXPECT_EQ(drive.run(TrackerState::Arrived, 60), TrackerState::Arrived);
  EXPECT_LT(std::hypot(drive.pose.x - 2, drive.pose.y - 2), 0.1);
  EXPECT_NEAR(drive.pose.theta, 2.5, 0.11);
  for (int i = 0; i < 100; ++i) {
    drive.run(TrackerState::Driving, 1);
    EXPECT_EQ(drive.tracker.state(), TrackerState::Arrived) << "it stays there";
  }
}

TEST(PathTracker, TurnsOnTheSpotTowardsAPathBehindIt) {
  Drive drive;
  drive.pose.theta = M_PI;
  ASSERT_TRUE(drive.tracker.set_path({{0, 0, 0}, {3, 0, 0}}));
  EXPECT_EQ(drive.run(TrackerState::Arrived, 60), TrackerState::Arrived);
  EXPECT_LT(drive.farthest_off, 0.25);
}

TEST(PathTracker, FollowsAPathThatComesBackInItsOrder) {
  Drive drive;
  ASSERT_TRUE(drive.tracker.set_path({{0, 0, 0}, {3, 0, 0}, {3, 0.3, 0}, {0, 0.3, M_PI}}));
  double farthest = 0;
  while (drive.tracker.state() != TrackerState::Arrived) {
    drive.run(TrackerState::Arrived, kStep);
    farthest = std::max(farthest, drive.pose.x);
    ASSERT_LT(farthest, 4);
  }
  EXPECT_GT(farthest, 2.7);
}

TEST(PathTracker, StopsBeforeAnObstacleAndGoesOnWithoutIt) {
  Drive drive;
  drive.obstacles = {{2, 0.1}};
  ASSERT_TRUE(drive.tracker.set_path({{0, 0, 0}, {4, 0, 0}}));
  EXPECT_EQ(drive.run(TrackerState::Blocked, 60), TrackerState::Blocked);
  drive.run(TrackerState::Arrived, 5);
  EXPECT_GT(std::hypot(2 - drive.pose.x, 0.1 - drive.pose.y), drive.settings.radius);
  EXPECT_GT(drive.pose.x, 1.5) << "no sooner than necessary";
  drive.obstacles.clear();
  EXPECT_EQ(drive.run(TrackerState::Arrived, 60), TrackerState::Arrived);
}

TEST(PathTracker, AnEmptyPathStopsIt) {
  Drive drive;
  ASSERT_TRUE(drive.tracker.set_path({{0, 0, 0}, {4, 0, 0}}));
  drive.run(TrackerState::Arrived, 2);
  ASSERT_TRUE(drive.tracker.set_path({}));
  drive.run(TrackerState::Arrived, 2);
  EXPECT_EQ(drive.tracker.state(), TrackerState::Idle);
  EXPECT_EQ(drive.tracker.brake(drive.settings, kStep).linear, 0);
}

TEST(PathTracker, RefusesPathsThatItCannotHold) {
  PathTracker tracker(2);
  EXPECT_FALSE(tracker.set_path({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}));
  EXPECT_FALSE(tracker.set_path({{0, 0, 0}, {std::nan(""), 0, 0}}));
  tracker.update({}, {}, {}, kStep);
  EXPECT_EQ(tracker.state(), TrackerState::Idle);
}

TEST(ObstaclePoints, AreSeenFromTheVehicleAndLeftOutEvenly) {
  messages::LaserScan scan{.first_angle = -M_PI / 2,
                           .angle_step = M_PI / 100,
                           .minimum_range = 0.1,
                           .maximum_range = 5,
                           .ranges = {}};
  scan.ranges.assign(101, 1.0F);
  scan.ranges[0] = std::numeric_limits<float>::infinity();
  scan.ranges[50] = 2;
  ObstaclePoints all(200);
  all.set(scan, {0.5, 0, M_PI / 2});
  ASSERT_EQ(all.points().size(), 100U);
  EXPECT_NEAR(all.points()[49].x, 0.5, 1e-9);
  EXPECT_NEAR(all.points()[49].y, 2, 1e-9);
  ObstaclePoints few(30);
  few.set(scan, {});
  EXPECT_GE(few.points().size(), 25U);
  EXPECT_LE(few.points().size(), 30U);
  EXPECT_GT(few.points().back().y, 0.95) << "all directions are represented";
}

rc::Gen<double> number_of(double low, double high) {
  return rc::gen::map(rc::gen::inRange(0, 100'001),
                      [=](int share) { return low + (high - low) * share / 1e5; });
}

RC_GTEST_PROP(FreeDistance, IsWhereACircleOnTheArcTouchesFirst, ()) {
  const double radius = *number_of(0.1, 0.5);
  const double curvature = *rc::gen::oneOf(number_of(-3, 3), rc::gen::just(0.0));
  const Point point{*number_of(-2, 2), *number_of(-2, 2)};
  RC_PRE(std::hypot(point.x, point.y) > radius + 1e-3);
  const double free = free_distance(std::array{point}, curvature, radius);
  constexpr double kFineStep = 0.002;
  const double all_round = std::min(8.0, std::abs(curvature) > 0 ? 2 * M_PI / std::abs(curvature) : 8.0);
  double closest = 1e9;
  for (double way = 0; way < std::min(free - kFineStep, all_round); way += kFineStep) {
    const Pose2D pose = moved({}, {1, curvature}, way);
    closest = std::min(closest, std::hypot(point.x - pose.x, point.y - pose.y));
  }
  RC_ASSERT(closest > radius - 1e-9);
  if (!std::isfinite(free)) return;
  const Pose2D touching = moved({}, {1, curvature}, free);
  RC_ASSERT(std::abs(std::hypot(point.x - touching.x, point.y - touching.y) - radius) < 1e-6);
}

RC_GTEST_PROP(PathTracker, KeepsItsLimitsWhateverHappens, ()) {
  Drive drive;
  const VehicleLimits& limits = drive.settings.limits;
  messages::Twist2D last;
  const int steps = *rc::gen::inRange(1, 200);
  for (int i = 0; i < steps; ++i) {
    if (*rc::gen::inRange(0, 20) == 0) {
      messages::Path path;
      const int poses = *rc::gen::inRange(0, 6);
      for (int k = 0; k < poses; ++k)
        path.poses.push_back({*number_of(-3, 3), *number_of(-3, 3), *number_of(-3, 3)});
      drive.tracker.set_path(path.poses);
      drive.obstacles = {{*number_of(-3, 3), *number_of(-3, 3)}};
    }
    const double step = *number_of(0.001, 0.2);
    const bool lost = *rc::gen::inRange(0, 30) == 0;
    const auto command = lost ? drive.tracker.brake(drive.settings, step)
                              : drive.tracker.update(drive.pose, drive.obstacles, drive.settings, step);
    RC_ASSERT(command.linear >= 0 && command.linear <= limits.speed + 1e-12);
    RC_ASSERT(std::abs(command.angular) <= limits.turn_rate + 1e-12);
    RC_ASSERT(command.linear - last.linear <= limits.acceleration * step + 1e-12);
    RC_ASSERT(last.linear - command.linear <= limits.deceleration * step + 1e-12);
    RC_ASSERT(std::abs(command.angular - last.angular) <= limits.angular_acceleration * step + 1e-12);
    last = command;
    drive.pose = moved(drive.pose, command, step);
  }
}

RC_GTEST_PROP(PathTracker, TouchesNothingThatItHasSeenInTime, ()) {
  Drive drive;
  const Point obstacle{*number_of(1.0, 3), *number_of(-0.6, 0.6)};
  drive.obstacles = {obstacle};
  drive.pose.theta = *number_of(-3, 3);
  drive.tracker.set_path({{0, 0, 0}, {*number_of(1, 3), *number_of(-1, 1), 0}, {4, *number_of(-1, 1), 0}});
  for (int i = 0; i < 400; ++i) {
    drive.run(TrackerState::Arrived, kStep);
    const double gap =
        std::hypot(obstacle.x - drive.pose.x, obstacle.y - drive.pose.y) - drive.settings.radius;
    RC_ASSERT(gap > 0);
  }
}

}  // namespace
}  // namespace navigation
