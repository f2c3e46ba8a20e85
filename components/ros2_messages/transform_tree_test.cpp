// SPDX-License-Identifier: Apache-2.0
//
// tests/ros2/tf2_judge_test.cpp compares its poses with those of tf2.
#include "transform_tree.hpp"
#include "transform_test_support.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <string>

namespace ros2_messages {
namespace {

using ::testing::HasSubstr;
using ::testing::StrEq;

TEST(TransformTree, TellsAPoseAtTheTimeThatAllMovingTransformsKnow) {
  TransformTree tree(4);
  EXPECT_EQ(tree.insert(made_transform("map", "odom", 1, 10), false), nullptr);
  EXPECT_EQ(tree.insert(made_transform("odom", "base", 1, 0), false), nullptr);
  EXPECT_EQ(tree.insert(made_transform("odom", "base", 3, 4), false), nullptr);
  EXPECT_EQ(tree.insert(made_transform("base", "laser", 99, 0.5), true), nullptr);
  EXPECT_EQ(tree.newest("map", "laser").pose.time, 1);
  EXPECT_EQ(tree.newest("map", "laser").frame, "odom") << "whose transform everything waits for";
  EXPECT_EQ(tree.newest("map", "laser").pose.pose.position.x(), 10.5);
  EXPECT_EQ(tree.insert(made_transform("map", "odom", 2, 20), false), nullptr);
  EXPECT_EQ(tree.newest("map", "laser").pose.time, 2);
  EXPECT_NEAR(tree.newest("map", "laser").pose.pose.position.x(), 22.5, 1e-12) << "between two transforms";
  EXPECT_NEAR(tree.newest("laser", "map").pose.pose.position.x(), -22.5, 1e-12);
  EXPECT_NEAR(tree.at("map", "laser", 1.5).pose.pose.position.x(), 16.5, 1e-12);
  EXPECT_TRUE(tree.newest("map", "laser").moves);
  EXPECT_FALSE(tree.newest("base", "laser").moves);
  EXPECT_EQ(tree.newest("base", "laser").pose.time, 0);
}

TEST(TransformTree, SaysWhyThereIsNoPose) {
  TransformTree tree(8);
  const auto why = [&](const char* frame, const char* child) {
    const Located located = tree.newest(frame, child);
    return located.problem == nullptr ? std::string() : located.problem + (" " + std::string(located.frame));
  };
  EXPECT_EQ(why("map", "base"), "no transform names frame base");
  tree.insert(made_transform("odom", "base", 1, 0), false);
  EXPECT_EQ(why("map", "base"), "no transform names frame map");
  tree.insert(made_transform("world", "map", 5, 0), false);
  EXPECT_EQ(why("map", "base"), "no chain of transforms leads from it to frame map");
  tree.insert(made_transform("world", "odom", 7, 0), false);
  EXPECT_EQ(why("map", "base"), "the times of transforms do not meet at frame odom");
  tree.insert(made_transform("base", "odom", 8, 0), false);
  EXPECT_THAT(why("map", "base"), HasSubstr("the transforms go round in a circle at frame"));
  EXPECT_THAT(why("base", "map"), HasSubstr("the transforms go round in a circle at frame"));
}

TEST(TransformTree, LeavesOutWhatIsNoTransform) {
  constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
  TransformTree tree(3);
  EXPECT_THAT(tree.insert(made_transform("", "base", 1, 0), false), HasSubstr("names no frame"));
  EXPECT_THAT(tree.insert(made_transform("map", "/", 1, 0), false), HasSubstr("names no frame"));
  EXPECT_THAT(tree.insert(made_transform("map", std::string(128, 'x'), 1, 0), false), HasSubstr("too long"));
  EXPECT_THAT(tree.insert(made_transform("map", "/map", 1, 0), false), HasSubstr("the same frame twice"));
  EXPECT_THAT(tree.insert(made_transform("map", "base", 1, kNotANumber), false), HasSubstr("not finite"));
  auto turned = made_transform("map", "base", 1, 0);
  turned.transform.rotation = {0, 0, 0, 0};
  EXPECT_THAT(tree.insert(turned, false), HasSubstr("not normalized"));
  turned.transform.rotation.w = kNotANumber;
  EXPECT_THAT(tree.insert(turned, true), HasSubstr("not normalized"));
  EXPECT_EQ(tree.size(), 0U) << "frames of which nothing is known need no room";
  EXPECT_EQ(tree.insert(made_transform("/map", "/base", 1, 0), false), nullptr);
  EXPECT_EQ(tree.insert(made_transform("base", "arm", 1, 0), false), nullptr);
  EXPECT_THAT(tree.insert(made_transform("arm", "tool", 1, 0), false), HasSubstr("more frames than"));
  EXPECT_EQ(tree.newest("map", "arm").problem, nullptr);
}

TEST(TransformTree, BeginsAnewWhereAClockWasSetBackButNotForSingleLateTransforms) {
  TransformTree tree(2);
  tree.insert(made_transform("map", "base", 100, 1), false);
  tree.insert(made_transform("map", "base", 101, 2), false);
  tree.insert(made_transform("map", "base", 100.5, 9), false);
  EXPECT_EQ(tree.newest("map", "base").pose.time, 101);
  EXPECT_EQ(tree.at("map", "base", 100.5).pose.pose.position.x(), 1.5) << "the late one is left out";
  for (int i = 0; i < TransformTree::kLateOnes; ++i)
    tree.insert(made_transform("map", "base", i, i), false);
  EXPECT_EQ(tree.newest("map", "base").pose.time, TransformTree::kLateOnes - 1);
}

TEST(TransformTree, LateTransformsAmongOthersNeverCount) {
  TransformTree tree(2);
  for (int i = 0; i < 100; ++i) {
    tree.insert(made_transform("map", "base", 100 + i, 1), false);
    tree.insert(made_transform("map", "base", i, 2), false);
    ASSERT_EQ(tree.newest("map", "base").pose.time, 100 + i) << "of two publishers, the one that is ahead";
  }
}

TEST(TransformTree, AFrameMayComeToAnotherParentOrBecomeStatic) {
  TransformTree tree(4);
  tree.insert(made_transform("map", "cup", 5, 1), false);
  tree.insert(made_transform("map", "hand", 5, 2), false);
  tree.insert(made_transform("hand", "cup", 6, 0.5), false);
  EXPECT_STREQ(tree.newest("map", "cup").problem, "the times of transforms do not meet at frame");
  tree.insert(made_transform("map", "hand", 6, 3), false);
  EXPECT_EQ(tree.newest("map", "cup").pose.pose.position.x(), 3.5);
  tree.insert(made_transform("map", "cup", 1, 8), true);
  EXPECT_EQ(tree.newest("map", "cup").pose.pose.position.x(), 8);
  EXPECT_FALSE(tree.newest("map", "cup").moves);
}

}  // namespace
}  // namespace ros2_messages
