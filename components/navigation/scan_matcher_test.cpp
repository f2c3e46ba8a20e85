// SPDX-License-Identifier: Apache-2.0
#include "scan_matcher.hpp"
#include "occupancy_map.hpp"
#include "simulated_room.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

namespace navigation {
namespace {

ClearanceMap map_of_two_rooms() {
  const test::Room room = test::two_rooms();
  OccupancyMap map({0.05, -0.5, -0.5, 180, 140});
  for (const Pose2D& pose : {Pose2D{1, 1, 0}, Pose2D{3, 5, 1}, Pose2D{1, 5, 2}, Pose2D{7, 5, -2},
                             Pose2D{5, 1, 3}, Pose2D{7.4, 1, 0}}) {
    for (int i = 0; i < 3; ++i)
      map.integrate(room.scan(pose, 720, 10), pose);
  }
  messages::OccupancyGrid grid;
  map.write_to(grid);
  ClearanceMap clearance(grid.cells.size());
  clearance.update(grid);
  return clearance;
}

RC_GTEST_PROP(ScanMatcher, FindsThePoseOfTheScanCloseToAWrongGuess, ()) {
  static const ClearanceMap map = map_of_two_rooms();
  const test::Room room = test::two_rooms();
  const auto from_to = [](double low, double high) {
    return low + (high - low) * *rc::gen::inRange(0, 1'000'001) / 1e6;
  };
  const Pose2D truth{from_to(0.4, 7.6), from_to(0.4, 5.6), from_to(-3, 3)};
  RC_PRE(room.clearance({truth.x, truth.y}) > 0.3);
  const Pose2D guess{truth.x + from_to(-0.14, 0.14), truth.y + from_to(-0.14, 0.14),
                     truth.theta + from_to(-0.12, 0.12)};
  ScanMatcher matcher(120);
  const auto match = matcher.match(map, room.scan(truth, 360, 8), guess, {});
  RC_ASSERT(match);
  RC_ASSERT(match->score > 0.8);
  RC_ASSERT(std::hypot(match->pose.x - truth.x, match->pose.y - truth.y) < 0.07);
  RC_ASSERT(std::abs(wrapped(match->pose.theta - truth.theta)) < 0.04);
}

TEST(ScanMatcher, SaysHowBadlyAScanFitsThatWasTakenElsewhere) {
  const ClearanceMap map = map_of_two_rooms();
  const test::Room other({{-1, -1, -0.9, 1}, {0.9, -1, 1, 1}, {-1, 0.9, 1, 1}, {-1, -1, 1, -0.9}});
  ScanMatcher matcher(120);
  const auto match = matcher.match(map, other.scan({0, 0, 0}, 360, 8), {2, 1.5, 0}, {});
  ASSERT_TRUE(match);
  EXPECT_LT(match->score, 0.4);
}

TEST(ScanMatcher, NeedsBeamsThatMeetSomething) {
  const ClearanceMap map = map_of_two_rooms();
  const test::Room room = test::two_rooms();
  ScanMatcher matcher(120);
  EXPECT_FALSE(matcher.match(map, room.scan({2, 1.5, 0}, 360, 0.3), {2, 1.5, 0}, {}));
  EXPECT_FALSE(matcher.match(map, {}, {2, 1.5, 0}, {}));
  EXPECT_FALSE(matcher.match(map, room.scan({2, 1.5, 0}, 360, 8), {std::nan(""), 1.5, 0}, {}));
}

}  // namespace
}  // namespace navigation
