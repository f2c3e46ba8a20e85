// SPDX-License-Identifier: Apache-2.0
#include "pose_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace manipulation {
namespace {

Pose pose_at(double x, double turn = 0) {
  Pose pose;
  pose.position.x() = x;
  pose.orientation = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ());
  return pose;
}

TEST(PoseFilter, FollowsWithItsTimeConstant) {
  PoseFilter filter;
  EXPECT_FALSE(filter.estimate());
  EXPECT_TRUE(filter.add(pose_at(1), 0, {}));
  EXPECT_EQ(filter.estimate()->position.x(), 1);
  EXPECT_TRUE(filter.add(pose_at(1.05, 0.5), 0.2, {.time_constant = 0.2}));
  const double share = 1 - std::exp(-1.0);
  EXPECT_NEAR(filter.estimate()->position.x(), 1 + 0.05 * share, 1e-12);
  EXPECT_NEAR(filter.estimate()->orientation.angularDistance(pose_at(0).orientation), 0.5 * share, 1e-9);
}

TEST(PoseFilter, SmoothsNoise) {
  PoseFilter filter;
  double worst = 0;
  for (int i = 0; i < 500; ++i) {
    filter.add(pose_at(1 + (i % 2 == 0 ? 0.01 : -0.01)), 0.02, {});
    if (i > 100) worst = std::max(worst, std::abs(filter.estimate()->position.x() - 1));
  }
  EXPECT_LT(worst, 0.002);
}

TEST(PoseFilter, LeavesOutASingleWrongPoseAndBelievesSeveral) {
  PoseFilter filter;
  filter.add(pose_at(1), 0, {});
  EXPECT_FALSE(filter.add(pose_at(3), 0.1, {}));
  EXPECT_EQ(filter.estimate()->position.x(), 1);
  EXPECT_TRUE(filter.add(pose_at(1), 0.1, {}));
  for (int i = 0; i < 4; ++i)
    EXPECT_FALSE(filter.add(pose_at(2), 0.1, {}));
  EXPECT_TRUE(filter.add(pose_at(2), 0.1, {}));
  EXPECT_EQ(filter.estimate()->position.x(), 2);
}

TEST(PoseFilter, PosesThatContradictEachOtherAreNeverBelieved) {
  PoseFilter filter;
  filter.add(pose_at(1), 0, {});
  for (int i = 0; i < 100; ++i)
    EXPECT_FALSE(filter.add(pose_at(3 + i), 0.1, {}));
  EXPECT_EQ(filter.estimate()->position.x(), 1);
  filter.reset();
  EXPECT_FALSE(filter.estimate());
}

}  // namespace
}  // namespace manipulation
