// SPDX-License-Identifier: Apache-2.0
#include "frontier_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace navigation {
namespace {

constexpr FrontierSettings kFine{.radius = 0.05, .smallest = 0.15, .size_weight = 0.5, .visit_radius = 0.15};

ClearanceMap map_of(const std::vector<std::string>& rows) {
  messages::OccupancyGrid grid{.resolution = 0.1,
                               .width = static_cast<std::uint32_t>(rows.front().size()),
                               .height = static_cast<std::uint32_t>(rows.size()),
                               .cells = {}};
  for (auto row = rows.rbegin(); row != rows.rend(); ++row) {
    for (const char c : *row)
      grid.cells.push_back(c == '#' ? std::int8_t{100} : c == '?' ? std::int8_t{-1} : std::int8_t{0});
  }
  ClearanceMap map(grid.cells.size());
  map.update(grid);
  return map;
}

Pose2D place(int x, int y) {
  return {0.1 * (x + 0.5), 0.1 * (y + 0.5), 0};
}

TEST(FrontierSearch, FindsTheBorderOfTheUnknownAndLooksThere) {
  const ClearanceMap map = map_of({"....????", "....????", "....????"});
  FrontierSearch search(100);
  const auto found = search.next(map, place(0, 1), kFine);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->goal.x, place(3, 1).x, 1e-6);
  EXPECT_NEAR(found->goal.y, place(3, 1).y, 1e-6);
  EXPECT_NEAR(found->goal.theta, 0, 1e-6);
  EXPECT_NEAR(found->length, 0.3, 1e-6);
  EXPECT_NEAR(found->distance, 0.3, 1e-6);
  EXPECT_EQ(search.found(), 1U);
}

TEST(FrontierSearch, LeavesOutWhatIsShortOrCannotBeReached) {
  FrontierSearch search(100);
  EXPECT_FALSE(search.next(map_of({"...#????", "...#????", "...#????"}), place(0, 1), kFine));
  EXPECT_FALSE(search.next(map_of({"...#..??", "...#..??", "...#..??"}), place(0, 1), kFine))
      << "behind a wall";
  EXPECT_FALSE(search.next(map_of({"...#????", "....????", "...#????"}), place(0, 1), kFine)) << "one cell";
  FrontierSettings wide = kFine;
  wide.radius = 0.25;
  const std::vector<std::string> corridor = {".....#####", ".....#####", "........??",
                                             "........??", ".....#####", ".....#####"};
  EXPECT_TRUE(search.next(map_of(corridor), place(1, 3), kFine));
  EXPECT_FALSE(search.next(map_of(corridor), place(1, 3), wide)) << "too narrow";
}

TEST(FrontierSearch, WeighsSizeAgainstDistance) {
  const ClearanceMap map =
      map_of({"??????????", ".........?", ".........?", "##.......?", "##.......?", "##??.....?"});
  FrontierSearch search(100);
  FrontierSettings settings = kFine;
  settings.size_weight = 0;
  const auto near = search.next(map, place(3, 2), settings);
  ASSERT_TRUE(near);
  EXPECT_LT(near->goal.y, 0.3) << "two cells, but close";
  settings.size_weight = 2;
  const auto large = search.next(map, place(3, 2), settings);
  ASSERT_TRUE(large);
  EXPECT_GT(large->length, near->length);
  EXPECT_EQ(search.found(), 2U);
}

TEST(FrontierSearch, DoesNotOfferWhatWasGivenUp) {
  const ClearanceMap map = map_of({"??....??", "??....??", "??....??"});
  FrontierSearch search(100);
  const auto first = search.next(map, place(3, 1), kFine);
  ASSERT_TRUE(first);
  EXPECT_TRUE(search.worth_while(map, first->goal, kFine));
  search.give_up(first->goal);
  const auto second = search.next(map, place(3, 1), kFine);
  ASSERT_TRUE(second);
  EXPECT_GT(std::abs(second->goal.x - first->goal.x), 0.15);
  search.give_up(second->goal);
  EXPECT_FALSE(search.next(map, place(3, 1), kFine));
  search.reset();
  EXPECT_TRUE(search.next(map, place(3, 1), kFine));
  for (int i = 0; i < 1000; ++i)
    search.give_up(place(100, 100));
  EXPECT_TRUE(search.next(map, place(3, 1), kFine));
}

TEST(FrontierSearch, IsOverWhereTheMapIsKnownOrTheVehicleIsOutside) {
  FrontierSearch search(100);
  const ClearanceMap known = map_of({"....", "....", "...."});
  EXPECT_FALSE(search.next(known, place(1, 1), kFine)) << "the edge of the map is not a frontier";
  EXPECT_FALSE(search.worth_while(known, place(1, 1), kFine));
  EXPECT_FALSE(search.next(map_of({"..??"}), place(-3, 0), kFine));
}

}  // namespace
}  // namespace navigation
