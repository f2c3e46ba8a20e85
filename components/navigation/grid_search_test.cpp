// SPDX-License-Identifier: Apache-2.0
#include "grid_search.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <queue>
#include <string>

namespace navigation {
namespace {

constexpr double kSide = 0.1;  // m, of the cells

/// '#' is occupied, '?' unknown; the first line is the row with the largest y.
messages::OccupancyGrid drawn(const std::vector<std::string>& rows) {
  messages::OccupancyGrid grid{.resolution = kSide,
                               .width = static_cast<std::uint32_t>(rows.front().size()),
                               .height = static_cast<std::uint32_t>(rows.size()),
                               .cells = {}};
  for (auto row = rows.rbegin(); row != rows.rend(); ++row) {
    for (const char c : *row)
      grid.cells.push_back(c == '#' ? std::int8_t{100} : c == '?' ? std::int8_t{-1} : std::int8_t{0});
  }
  return grid;
}

Pose2D at(int x, int y, double theta = 0) {
  return {kSide * (x + 0.5), kSide * (y + 0.5), theta};
}

struct Planned {
  PlanProblem problem;
  messages::Path path;
};

Planned plan(const messages::OccupancyGrid& grid, const Pose2D& start, const Pose2D& goal,
             const PlanSettings& settings) {
  ClearanceMap map(grid.cells.size());
  map.update(grid);
  GridSearch search(grid.cells.size(), 100);
  Planned planned{};
  planned.problem = search.plan(map, start, goal, settings, planned.path);
  return planned;
}

/// A vehicle that fits through gaps of one cell, and does not mind obstacles.
constexpr PlanSettings kThin{
    .radius = 0.05, .comfort = 0.05, .comfort_weight = 0, .cross_unknown = false, .unknown_cost = 1};

TEST(GridSearch, AStraightWayHasNoCorners) {
  const auto found = plan(drawn({".........", ".........", "........."}), at(0, 0), at(8, 2, 1.5), kThin);
  ASSERT_EQ(found.problem, PlanProblem::None);
  ASSERT_EQ(found.path.poses.size(), 2U);
  EXPECT_NEAR(found.path.poses[0].theta, std::atan2(2, 8), 1e-9);
  EXPECT_EQ(found.path.poses[1].theta, 1.5) << "the heading of the goal";
}

TEST(GridSearch, GoesAroundAWallAndCutsNoCorner) {
  const auto found =
      plan(drawn({".........", "....#....", "....#....", "....#...."}), at(1, 0), at(7, 0), kThin);
  ASSERT_EQ(found.problem, PlanProblem::None);
  double highest = 0;
  for (const Pose2D& pose : found.path.poses)
    highest = std::max(highest, pose.y);
  EXPECT_NEAR(highest, at(0, 3).y, 1e-9);
  EXPECT_LE(found.path.poses.size(), 6U);
}

TEST(GridSearch, TakesAGapOnlyIfTheVehicleFitsThrough) {
  std::vector<std::string> rows(11, std::string(11, '.'));
  rows[5] = "#####.#####";
  PlanSettings settings = kThin;
  EXPECT_EQ(plan(drawn(rows), at(5, 9), at(5, 1), settings).problem, PlanProblem::None);
  settings.radius = 0.15;
  EXPECT_EQ(plan(drawn(rows), at(5, 9), at(5, 1), settings).problem, PlanProblem::NoWay);
}

TEST(GridSearch, KeepsItsDistanceWhereThereIsRoom) {
  std::vector<std::string> rows(21, std::string(30, '.'));
  rows[10] = std::string(10, '.') + "#" + std::string(19, '.');
  PlanSettings settings = kThin;
  settings.comfort = 0.6;
  settings.comfort_weight = 10;
  const auto found = plan(drawn(rows), at(0, 10), at(20, 10), settings);
  ASSERT_EQ(found.problem, PlanProblem::None);
  double farthest = 0;
  for (const Pose2D& pose : found.path.poses)
    farthest = std::max(farthest, std::abs(pose.y - at(0, 10).y));
  EXPECT_GT(farthest, 0.3);
}

TEST(GridSearch, SaysWhyThereIsNoPath) {
  const auto grid = drawn({"..#....", "..#..#.", "..#....", "?.#...."});
  EXPECT_EQ(plan(grid, at(-1, 0), at(1, 1), kThin).problem, PlanProblem::StartOutside);
  EXPECT_EQ(plan(grid, at(2, 0), at(1, 1), kThin).problem, PlanProblem::StartOccupied);
  EXPECT_EQ(plan(grid, at(1, 1), at(7, 0), kThin).problem, PlanProblem::GoalOutside);
  EXPECT_EQ(plan(grid, at(1, 1), at(5, 2), kThin).problem, PlanProblem::GoalOccupied);
  EXPECT_EQ(plan(grid, at(1, 3), at(6, 0), kThin).problem, PlanProblem::NoWay);
  for (const PlanProblem problem : {PlanProblem::NoWay, PlanProblem::GoalOutside, PlanProblem::NoMap})
    EXPECT_FALSE(explain(problem).empty());
}

TEST(GridSearch, CrossesUnknownCellsOnlyIfItMay) {
  const auto grid = drawn({"..?..", "..?..", "..?.."});
  PlanSettings settings = kThin;
  EXPECT_EQ(plan(grid, at(0, 1), at(4, 1), settings).problem, PlanProblem::NoWay);
  EXPECT_EQ(plan(grid, at(0, 1), at(2, 1), settings).problem, PlanProblem::GoalUnknown);
  settings.cross_unknown = true;
  EXPECT_EQ(plan(grid, at(0, 1), at(4, 1), settings).problem, PlanProblem::None);
  EXPECT_EQ(plan(grid, at(0, 1), at(2, 1), settings).problem, PlanProblem::None);
}

TEST(GridSearch, EndsCloseToAGoalThatIsNotFree) {
  const auto grid = drawn({".......", "...###.", "...###.", "...###."});
  PlanSettings settings = kThin;
  EXPECT_EQ(plan(grid, at(0, 0), at(4, 1), settings).problem, PlanProblem::GoalOccupied);
  settings.goal_tolerance = 0.25;
  const auto found = plan(grid, at(0, 0), at(4, 1), settings);
  ASSERT_EQ(found.problem, PlanProblem::None);
  const Pose2D& end = found.path.poses.back();
  EXPECT_LE(std::hypot(end.x - at(4, 1).x, end.y - at(4, 1).y), 0.25);
}

TEST(GridSearch, FindsTheWayOutOfAPlaceThatIsTooNarrow) {
  std::vector<std::string> rows(20, std::string(20, '.'));
  for (std::string& row : rows)
    row[0] = '#';
  PlanSettings settings = kThin;
  settings.radius = 0.4;
  const auto out = plan(drawn(rows), at(2, 10), at(15, 10), settings);
  EXPECT_EQ(out.problem, PlanProblem::None);
  const auto along = plan(drawn(rows), at(2, 2), at(2, 17), settings);
  EXPECT_EQ(along.problem, PlanProblem::GoalOccupied) << "only close to the start";
}

TEST(GridSearch, RefusesPathsWithTooManyCorners) {
  const auto grid = drawn({".........", ".#######.", ".........", "########.", "........."});
  ClearanceMap map(grid.cells.size());
  map.update(grid);
  GridSearch search(grid.cells.size(), 2);
  messages::Path path;
  EXPECT_EQ(search.plan(map, at(0, 0), at(0, 4), kThin, path), PlanProblem::TooManyCorners);
  EXPECT_TRUE(path.poses.empty());
  EXPECT_EQ(search.plan(map, at(0, 0), at(7, 0), kThin, path), PlanProblem::None);
}

/// The cost of the best way on eight neighbours, without the heuristic and the heap of the real search.
std::optional<double> cheapest(const ClearanceMap& map, Cell start, Cell goal, const PlanSettings& settings) {
  const GridFrame& frame = map.frame();
  const Passability passability(map, settings, start);
  std::vector<double> costs(frame.size(), 1e30);
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  costs[frame.index(start)] = 0;
  open.emplace(0, frame.index(start));
  while (!open.empty()) {
    const auto [cost, index] = open.top();
    open.pop();
    if (cost > costs[index]) continue;
    const Cell cell = frame.cell(index);
    if (cell == goal) return cost;
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        const Cell next{cell.x + dx, cell.y + dy};
        if (!frame.contains(next) || !passability.passable(frame.index(next)) ||
            !passability.passable(frame.index({cell.x + dx, cell.y})) ||
            !passability.passable(frame.index({cell.x, cell.y + dy})))
          continue;
        const double step = 0.5 * (passability.cost(index) + passability.cost(frame.index(next)));
        const double sum = cost + step * std::hypot(dx, dy) * frame.resolution;
        if (sum >= costs[frame.index(next)]) continue;
        costs[frame.index(next)] = sum;
        open.emplace(sum, frame.index(next));
      }
    }
  }
  return std::nullopt;
}

struct RandomCase {
  messages::OccupancyGrid grid;
  Cell start;
  Cell goal;
  PlanSettings settings;
};

RandomCase random_case() {
  RandomCase c;
  const int width = *rc::gen::inRange(2, 25);
  const int height = *rc::gen::inRange(2, 25);
  c.grid = {.resolution = kSide,
            .width = static_cast<std::uint32_t>(width),
            .height = static_cast<std::uint32_t>(height),
            .cells = *rc::gen::container<std::vector<std::int8_t>>(
                static_cast<std::size_t>(width * height),
                rc::gen::weightedElement<std::int8_t>({{14, 0}, {2, 100}, {2, -1}}))};
  c.start = {*rc::gen::inRange(0, width), *rc::gen::inRange(0, height)};
  c.goal = {*rc::gen::inRange(0, width), *rc::gen::inRange(0, height)};
  c.settings = kThin;
  c.settings.radius = *rc::gen::element(0.05, 0.12, 0.21);
  c.settings.comfort = c.settings.radius + *rc::gen::element(0.0, 0.2);
  c.settings.comfort_weight = *rc::gen::element(0.0, 4.0);
  c.settings.cross_unknown = *rc::gen::arbitrary<bool>();
  c.settings.unknown_cost = *rc::gen::element(1.0, 3.0);
  return c;
}

RC_GTEST_PROP(GridSearch, FindsAWayExactlyIfThereIsOneAndNoneIsCheaper, ()) {
  const RandomCase c = random_case();
  ClearanceMap map(c.grid.cells.size());
  map.update(c.grid);
  const GridFrame& frame = map.frame();
  RC_PRE(map.clearance(frame.index(c.start)) > 0);
  const Planned found = plan(c.grid, at(c.start.x, c.start.y), at(c.goal.x, c.goal.y), c.settings);
  const auto best = cheapest(map, c.start, c.goal, c.settings);
  RC_ASSERT((found.problem == PlanProblem::None) == best.has_value());
  RC_ASSERT(found.path.poses.empty() == !best.has_value());
  if (!best) return;
  const Passability passability(map, c.settings, c.start);
  double cost = 0;
  for (std::size_t i = 1; i < found.path.poses.size(); ++i) {
    const Pose2D& a = found.path.poses[i - 1];
    const Pose2D& b = found.path.poses[i];
    traverse(frame, {a.x, a.y}, {b.x, b.y}, [&](Cell cell, double length) {
      RC_ASSERT(passability.passable(frame.index(cell)));
      cost += length * passability.cost(frame.index(cell));
      return true;
    });
  }
  // Each shortcut may cost a rounding error more than what it replaces.
  RC_ASSERT(cost <= *best + 1e-3 * static_cast<double>(found.path.poses.size()));
}

}  // namespace
}  // namespace navigation
