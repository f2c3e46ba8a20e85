// SPDX-License-Identifier: Apache-2.0
#include "frontier_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace navigation {
namespace {

constexpr std::array<Cell, 4> kSides{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
constexpr std::array<Cell, 8> kAround{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};
constexpr float kNotReached = -1;

/// Calls `visit` with the index of each of the neighbours that lie in the grid.
template <std::size_t n, class Visit>
void for_neighbours(const GridFrame& frame, std::size_t index, const std::array<Cell, n>& offsets,
                    Visit visit) {
  const Cell cell = frame.cell(index);
  for (const Cell offset : offsets) {
    const Cell next{cell.x + offset.x, cell.y + offset.y};
    if (frame.contains(next)) visit(frame.index(next), offset);
  }
}

}  // namespace

FrontierSearch::FrontierSearch(std::size_t most_cells)
    : way_(most_cells), taken_(most_cells), reached_(most_cells), members_(most_cells) {}

bool FrontierSearch::passable(const ClearanceMap& map, std::size_t index, double radius) const {
  return map.known(index) && map.clearance(index) >= static_cast<float>(radius);
}

bool FrontierSearch::is_frontier(const ClearanceMap& map, std::size_t index) const {
  bool unknown = false;
  for_neighbours(map.frame(), index, kSides,
                 [&](std::size_t next, Cell /*offset*/) { unknown = unknown || !map.known(next); });
  return unknown;
}

/// Breadth first over cells that the vehicle can cross, as the planner lets it: close to where it stands,
/// with no more clearance than there is.
void FrontierSearch::measure_ways(const ClearanceMap& map, Cell start, double radius) {
  constexpr double kWayOut = 1.5;  // radii around the vehicle
  const GridFrame& frame = map.frame();
  std::fill_n(way_.begin(), frame.size(), kNotReached);
  std::fill_n(taken_.begin(), frame.size(), std::uint8_t{0});
  const std::size_t first = frame.index(start);
  const double at_start = std::min<double>(map.clearance(first), radius);
  const double exempt = kWayOut * radius / frame.resolution;
  way_[first] = 0;
  reached_[0] = static_cast<std::uint32_t>(first);
  reached_count_ = 1;
  for (std::size_t done = 0; done < reached_count_; ++done) {
    const std::size_t index = reached_[done];
    for_neighbours(frame, index, kAround, [&](std::size_t next, Cell offset) {
      if (way_[next] != kNotReached) return;
      const Cell cell = frame.cell(next);
      const bool near = std::hypot(cell.x - start.x, cell.y - start.y) <= exempt;
      const bool way_out =
          near && map.clearance(next) > 0 && map.clearance(next) >= static_cast<float>(at_start);
      if (!way_out && !passable(map, next, radius)) return;
      way_[next] = way_[index] + (offset.x != 0 && offset.y != 0 ? 1.41421356F : 1.0F);
      reached_[reached_count_++] = static_cast<std::uint32_t>(next);
    });
  }
}

/// Puts the frontier cells that are connected with `seed`, which is one, into members_; their number.
std::size_t FrontierSearch::collect(const ClearanceMap& map, std::size_t seed) {
  std::size_t count = 0;
  members_[count++] = static_cast<std::uint32_t>(seed);
  taken_[seed] = 1;
  for (std::size_t done = 0; done < count; ++done) {
    for_neighbours(map.frame(), members_[done], kAround, [&](std::size_t next, Cell /*offset*/) {
      if (taken_[next] != 0 || way_[next] == kNotReached || !map.known(next) || !is_frontier(map, next))
        return;
      taken_[next] = 1;
      members_[count++] = static_cast<std::uint32_t>(next);
    });
  }
  return count;
}

Frontier FrontierSearch::describe(const ClearanceMap& map, std::size_t members) const {
  const GridFrame& frame = map.frame();
  Point middle;
  for (std::size_t i = 0; i < members; ++i) {
    const Point place = frame.centre(frame.cell(members_[i]));
    middle.x += place.x / static_cast<double>(members);
    middle.y += place.y / static_cast<double>(members);
  }
  // The middle of a bent frontier need not be free; the member next to it is.
  Frontier frontier;
  frontier.length = static_cast<double>(members) * frame.resolution;
  double nearest = std::numeric_limits<double>::infinity();
  std::size_t chosen = members_[0];
  for (std::size_t i = 0; i < members; ++i) {
    const Point place = frame.centre(frame.cell(members_[i]));
    const double distance = std::hypot(place.x - middle.x, place.y - middle.y);
    if (distance >= nearest) continue;
    nearest = distance;
    chosen = members_[i];
  }
  double look_x = 0;
  double look_y = 0;
  for_neighbours(frame, chosen, kSides, [&](std::size_t next, Cell offset) {
    if (map.known(next)) return;
    look_x += offset.x;
    look_y += offset.y;
  });
  const Point place = frame.centre(frame.cell(chosen));
  frontier.goal = {place.x, place.y, std::atan2(look_y, look_x)};
  frontier.distance = double{way_[chosen]} * frame.resolution;
  return frontier;
}

std::optional<Frontier> FrontierSearch::next(const ClearanceMap& map, const Pose2D& vehicle,
                                             const FrontierSettings& settings) {
  found_ = 0;
  const GridFrame& frame = map.frame();
  const Cell start = frame.cell_of({vehicle.x, vehicle.y});
  if (!frame.contains(start) || frame.size() > way_.size()) return std::nullopt;
  measure_ways(map, start, settings.radius);
  std::optional<Frontier> best;
  const auto worth = [&](const Frontier& frontier) {
    return frontier.distance - settings.size_weight * frontier.length;
  };
  for (std::size_t i = 0; i < reached_count_; ++i) {
    const std::size_t index = reached_[i];
    if (taken_[index] != 0 || !map.known(index) || !is_frontier(map, index)) continue;
    const Frontier frontier = describe(map, collect(map, index));
    if (frontier.length < settings.smallest || was_given_up(frontier.goal, settings.visit_radius)) continue;
    ++found_;
    if (!best || worth(frontier) < worth(*best)) best = frontier;
  }
  return best;
}

bool FrontierSearch::worth_while(const ClearanceMap& map, const Pose2D& place,
                                 const FrontierSettings& settings) const {
  const GridFrame& frame = map.frame();
  const Cell middle = frame.cell_of({place.x, place.y});
  if (!frame.contains(middle)) return false;
  const auto reach = static_cast<int>(std::min(settings.visit_radius / frame.resolution, 1e4));
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const Cell cell{middle.x + dx, middle.y + dy};
      if (dx * dx + dy * dy > reach * reach || !frame.contains(cell)) continue;
      const std::size_t index = frame.index(cell);
      if (passable(map, index, settings.radius) && is_frontier(map, index)) return true;
    }
  }
  return false;
}

bool FrontierSearch::was_given_up(const Pose2D& goal, double radius) const {
  return std::any_of(
      given_up_.begin(), given_up_.begin() + static_cast<std::ptrdiff_t>(given_up_count_),
      [&](const Pose2D& place) { return std::hypot(place.x - goal.x, place.y - goal.y) <= radius; });
}

void FrontierSearch::give_up(const Pose2D& place) {
  if (given_up_count_ == kMostGivenUp) {
    std::shift_left(given_up_.begin(), given_up_.end(), 1);
    --given_up_count_;
  }
  given_up_[given_up_count_++] = place;
}

}  // namespace navigation
