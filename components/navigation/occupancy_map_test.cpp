// SPDX-License-Identifier: Apache-2.0
#include "occupancy_map.hpp"
#include "pose_history.hpp"
#include "simulated_room.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace navigation {
namespace {

using test::Room;

/// A number from `low` to `high`.
rc::Gen<double> number_between(double low, double high) {
  return rc::gen::map(rc::gen::inRange(0, 1'000'001),
                      [=](int share) { return low + (high - low) * share / 1e6; });
}

RC_GTEST_PROP(Traverse, VisitsConnectedCellsFromTheFirstToTheLast, ()) {
  const GridFrame frame{0.1, -1, -1, 20, 20};
  const Point from{*number_between(-2, 2), *number_between(-2, 2)};
  const Point to{*number_between(-2, 2), *number_between(-2, 2)};
  std::vector<Cell> cells;
  double length = 0;
  RC_ASSERT(traverse(frame, from, to, [&](Cell cell, double part) {
    cells.push_back(cell);
    length += part;
    return true;
  }));
  RC_ASSERT(cells.front() == frame.cell_of(from));
  RC_ASSERT(cells.back() == frame.cell_of(to));
  for (std::size_t i = 1; i < cells.size(); ++i)
    RC_ASSERT(std::abs(cells[i].x - cells[i - 1].x) + std::abs(cells[i].y - cells[i - 1].y) == 1);
  RC_ASSERT(std::abs(length - std::hypot(to.x - from.x, to.y - from.y)) < 1e-9);
  for (const Cell cell : cells) {  // no cell lies aside of the line
    const Point centre = frame.centre(cell);
    const double aside = (centre.x - from.x) * (to.y - from.y) - (centre.y - from.y) * (to.x - from.x);
    RC_ASSERT(std::abs(aside) <= 0.0708 * std::hypot(to.x - from.x, to.y - from.y) + 1e-9);
  }
}

TEST(GridFrame, PlacesThatAreNoNumbersLieOutside) {
  const GridFrame frame{0.1, -1, -1, 20, 20};
  EXPECT_FALSE(frame.contains(frame.cell_of({std::nan(""), 0})));
  EXPECT_FALSE(frame.contains(frame.cell_of({0, std::numeric_limits<double>::infinity()})));
  EXPECT_FALSE(frame.contains(frame.cell_of({-1e300, 0})));
  EXPECT_TRUE(frame.contains(frame.cell_of({0, 0})));
}

TEST(OccupancyMap, ABeamEmptiesItsWayAndFillsItsEnd) {
  OccupancyMap map({0.1, 0, 0, 50, 10});
  messages::LaserScan scan{.minimum_range = 0.1, .maximum_range = 10, .ranges = {2.0F}};
  map.integrate(scan, {0.55, 0.55, 0});
  EXPECT_GT(map.occupancy({25, 5}), 60);
  for (int x = 5; x < 25; ++x)
    EXPECT_LT(map.occupancy({x, 5}), 50) << x;
  EXPECT_EQ(map.occupancy({26, 5}), -1) << "behind what was met";
  EXPECT_EQ(map.occupancy({10, 6}), -1) << "beside the beam";
}

TEST(OccupancyMap, ABeamThatMeetsNothingEmptiesUpToTheLongestBeam) {
  OccupancyMap map({0.1, 0, 0, 50, 10}, {.longest_beam = 3});
  const float nothing = std::numeric_limits<float>::infinity();
  map.integrate({.minimum_range = 0.1, .maximum_range = 10, .ranges = {nothing}}, {0.55, 0.55, 0});
  EXPECT_LT(map.occupancy({34, 5}), 50);
  EXPECT_GE(map.occupancy({34, 5}), 0);
  EXPECT_EQ(map.occupancy({37, 5}), -1);
  map.clear();
  EXPECT_EQ(map.occupancy({34, 5}), -1);
}

TEST(OccupancyMap, IgnoresRangesThatMeanNothing) {
  OccupancyMap map({0.1, 0, 0, 20, 20});
  messages::LaserScan scan{.minimum_range = 0.5, .maximum_range = 10, .ranges = {0.2F, std::nanf(""), -1.0F}};
  map.integrate(scan, {1, 1, 0});
  map.integrate({.maximum_range = 10, .ranges = {1.0F}}, {std::nan(""), 1, 0});
  for (int x = 0; x < 20; ++x) {
    for (int y = 0; y < 20; ++y)
      EXPECT_EQ(map.occupancy({x, y}), -1);
  }
}

TEST(OccupancyMap, ForgetsWhatHasMovedAway) {
  OccupancyMap map({0.1, 0, 0, 50, 10});
  messages::LaserScan scan{.minimum_range = 0.1, .maximum_range = 10, .ranges = {2.0F}};
  for (int i = 0; i < 1000; ++i)
    map.integrate(scan, {0.55, 0.55, 0});
  EXPECT_GT(map.occupancy({25, 5}), 95);
  scan.ranges = {3.0F};
  for (int i = 0; i < 20; ++i)
    map.integrate(scan, {0.55, 0.55, 0});
  EXPECT_LT(map.occupancy({25, 5}), 30);
}

TEST(OccupancyMap, ScansOfARoomGiveItsWalls) {
  const Room room = test::two_rooms();
  OccupancyMap map({0.05, -0.5, -0.5, 180, 140});
  for (const Pose2D& pose : {Pose2D{1, 1, 0}, Pose2D{3, 5, 1}, Pose2D{7, 5, -2}, Pose2D{5, 1, 3}}) {
    for (int i = 0; i < 4; ++i)
      map.integrate(room.scan(pose, 720, 8), pose);
  }
  messages::OccupancyGrid grid;
  map.write_to(grid);
  int free = 0;
  for (std::size_t i = 0; i < grid.cells.size(); ++i) {
    const GridFrame frame = frame_of(grid);
    const double clearance = room.clearance(frame.centre(frame.cell(i)));
    if (grid.cells[i] >= 0 && grid.cells[i] < 40) {
      ++free;
      EXPECT_GT(clearance, 0) << "free cells lie in the room";
    } else if (grid.cells[i] > 60) {
      EXPECT_LT(clearance, 0.05) << "occupied cells lie at walls";
    }
  }
  EXPECT_GT(free * 0.05 * 0.05, 0.9 * (48 - 0.48 - 1.12 - 0.5)) << "square metres";
}

TEST(PoseHistory, InterpolatesAndPredictsALittle) {
  PoseHistory history;
  EXPECT_FALSE(history.at(0));
  history.add({1, {0, 0, 3.0}, {}});
  history.add({2, {1, 2, -3.0}, {.linear = 2, .angular = 0}});
  const auto half = history.at(1.5);
  ASSERT_TRUE(half);
  EXPECT_NEAR(half->x, 0.5, 1e-12);
  EXPECT_NEAR(half->y, 1, 1e-12);
  EXPECT_NEAR(std::abs(half->theta), M_PI, 1e-9) << "the short way round";
  const auto ahead = history.at(2.25);
  ASSERT_TRUE(ahead);
  EXPECT_NEAR(ahead->x, 1 + 0.5 * std::cos(-3.0), 1e-9);
  EXPECT_FALSE(history.at(0.5));
  EXPECT_FALSE(history.at(4));
}

TEST(PoseHistory, KeepsTheNewestAndBeginsAgainWhenTimeGoesBack) {
  PoseHistory history;
  for (int i = 0; i < 1000; ++i)
    history.add({0.1 * i, {0.1 * i, 0, 0}, {}});
  EXPECT_NEAR(history.at(95.05)->x, 95.05, 1e-9);
  EXPECT_FALSE(history.at(1));
  history.add({1, {7, 0, 0}, {}});
  EXPECT_NEAR(history.at(1)->x, 7, 1e-12);
  EXPECT_FALSE(history.at(95));
}

RC_GTEST_PROP(Poses, InverseUndoesAndMovesAddUp, ()) {
  const auto any = [] {
    return Pose2D{*number_between(-9, 9), *number_between(-9, 9), *number_between(-3, 3)};
  };
  const Pose2D pose = any();
  const Pose2D same = compose(compose(pose, inverse(pose)), pose);
  RC_ASSERT(std::hypot(same.x - pose.x, same.y - pose.y) < 1e-9);
  RC_ASSERT(std::abs(wrapped(same.theta - pose.theta)) < 1e-9);
  const messages::Twist2D twist{*number_between(-1, 1), *number_between(-2, 2)};
  const Pose2D once = moved(pose, twist, 0.8);
  const Pose2D twice = moved(moved(pose, twist, 0.3), twist, 0.5);
  RC_ASSERT(std::hypot(once.x - twice.x, once.y - twice.y) < 1e-9);
  RC_ASSERT(std::abs(wrapped(once.theta - twice.theta)) < 1e-9);
}

}  // namespace
}  // namespace navigation
