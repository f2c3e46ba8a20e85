// SPDX-License-Identifier: Apache-2.0
#include "clearance_map.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>

namespace navigation {
namespace {

messages::OccupancyGrid grid_of(std::uint32_t width, std::uint32_t height, std::vector<std::int8_t> cells) {
  return {.resolution = 0.5, .width = width, .height = height, .cells = std::move(cells)};
}

RC_GTEST_PROP(ClearanceMap, IsTheDistanceToTheNearestOccupiedCell, ()) {
  const auto width = *rc::gen::inRange<std::uint32_t>(1, 20);
  const auto height = *rc::gen::inRange<std::uint32_t>(1, 20);
  auto grid =
      grid_of(width, height,
              *rc::gen::container<std::vector<std::int8_t>>(
                  width * height, rc::gen::weightedElement<std::int8_t>({{6, 0}, {2, 100}, {2, -1}})));
  ClearanceMap map(400);
  RC_ASSERT(map.fits(grid));
  map.update(grid);
  const GridFrame frame = frame_of(grid);
  for (std::size_t i = 0; i < frame.size(); ++i) {
    double nearest = ClearanceMap::kNothingNear;
    for (std::size_t j = 0; j < frame.size(); ++j) {
      const Cell a = frame.cell(i);
      const Cell b = frame.cell(j);
      if (grid.cells[j] == 100) nearest = std::min(nearest, 0.5 * std::hypot(a.x - b.x, a.y - b.y));
    }
    RC_ASSERT(std::abs(map.clearance(i) - nearest) < 1e-4);
    RC_ASSERT(map.known(i) == (grid.cells[i] >= 0));
  }
}

TEST(ClearanceMap, RefusesGridsThatContradictThemselvesOrAreTooLarge) {
  const ClearanceMap map(6);
  EXPECT_TRUE(map.fits(grid_of(3, 2, std::vector<std::int8_t>(6))));
  EXPECT_FALSE(map.fits(grid_of(3, 2, std::vector<std::int8_t>(5))));
  EXPECT_FALSE(map.fits(grid_of(4, 2, std::vector<std::int8_t>(8))));
  EXPECT_FALSE(map.fits(grid_of(0, 0, {})));
  auto grid = grid_of(1, 1, {0});
  grid.resolution = 0;
  EXPECT_FALSE(map.fits(grid));
  grid.resolution = 0.1;
  grid.x = std::nan("");
  EXPECT_FALSE(map.fits(grid));
}

}  // namespace
}  // namespace navigation
