// SPDX-License-Identifier: Apache-2.0
#include "timed_poses.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace manipulation {
namespace {

messages::TimedPose entry_at(double time, double x, double turn = 0) {
  messages::TimedPose entry;
  entry.time = time;
  entry.pose.position.x() = x;
  entry.pose.orientation = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ());
  return entry;
}

TEST(TimedPoses, InterpolatesBetweenTwoTimes) {
  TimedPoses poses;
  EXPECT_FALSE(poses.at(0));
  poses.add(entry_at(1, 0));
  poses.add(entry_at(2, 4, 1));
  const auto between = poses.at(1.25);
  ASSERT_TRUE(between);
  EXPECT_NEAR(between->position.x(), 1, 1e-12);
  EXPECT_NEAR(between->orientation.angularDistance(entry_at(0, 0, 0.25).pose.orientation), 0, 1e-6);
  EXPECT_NEAR(poses.at(9)->position.x(), 4, 1e-12) << "the newest one";
  EXPECT_FALSE(poses.at(0.9));
  EXPECT_FALSE(poses.at(std::nan("")));
}

TEST(TimedPoses, KeepsTheNewestAndBeginsAnewWhenTimeGoesBack) {
  TimedPoses poses;
  for (int i = 0; i < 1000; ++i)
    poses.add(entry_at(i, i));
  EXPECT_NEAR(poses.at(950.5)->position.x(), 950.5, 1e-9);
  EXPECT_FALSE(poses.at(10));
  poses.add(entry_at(std::nan(""), 1));
  poses.add(entry_at(2000, std::nan("")));
  EXPECT_NEAR(poses.at(2000)->position.x(), 999, 1e-9) << "what makes no sense is ignored";
  poses.add(entry_at(5, 7));
  EXPECT_NEAR(poses.at(5)->position.x(), 7, 1e-9);
  EXPECT_FALSE(poses.at(4));
}

}  // namespace
}  // namespace manipulation
