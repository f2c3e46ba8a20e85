// SPDX-License-Identifier: Apache-2.0
#include "grid_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace navigation {
namespace {

constexpr float kImpassable = std::numeric_limits<float>::infinity();
constexpr float kDiagonal = 1.41421356F;

/// Cells from `a` to `b` in steps to eight neighbours.
float octile(Cell a, Cell b) {
  const int dx = std::abs(a.x - b.x);
  const int dy = std::abs(a.y - b.y);
  return static_cast<float>(std::max(dx, dy)) + (kDiagonal - 1) * static_cast<float>(std::min(dx, dy));
}

}  // namespace

std::string_view explain(PlanProblem problem) {
  switch (problem) {
    case PlanProblem::None:
      return "there is a path";
    case PlanProblem::NoGoal:
      return "no goal was set: call set_goal or connect the port goal";
    case PlanProblem::NoPose:
      return "the pose is not known yet: connect the port pose";
    case PlanProblem::NoMap:
      return "there is no map yet: connect the port map";
    case PlanProblem::InvalidMap:
      return "the map is inconsistent or larger than most_cells: increase that property";
    case PlanProblem::StartOutside:
      return "the vehicle is outside of the map: make the map larger";
    case PlanProblem::StartOccupied:
      return "the vehicle stands where the map is occupied: check its pose";
    case PlanProblem::GoalOutside:
      return "the goal is outside of the map: set another one";
    case PlanProblem::GoalOccupied:
      return "the goal is too close to an obstacle: set another one or increase goal_tolerance";
    case PlanProblem::GoalUnknown:
      return "nothing is known about the goal's place: explore it or set cross_unknown";
    case PlanProblem::NoWay:
      return "no way that is wide enough leads to the goal: explore, or reduce radius";
    case PlanProblem::TooManyCorners:
      return "the path has more than most_poses corners: increase that property";
  }
  return "";
}

Passability::Passability(const ClearanceMap& map, const PlanSettings& settings, Cell start)
    : map_(&map), settings_(settings), start_(start) {
  constexpr double kWayOut = 1.5;  // radii until the usual clearance must be reached
  const float at_start = map.clearance(map.frame().index(start));
  reduced_clearance_ = std::min(at_start, static_cast<float>(settings.radius));
  exempt_cells_ = kWayOut * settings.radius / map.frame().resolution;
}

bool Passability::near_start(std::size_t index) const {
  const Cell cell = map_->frame().cell(index);
  return std::hypot(cell.x - start_.x, cell.y - start_.y) <= exempt_cells_;
}

bool Passability::passable(std::size_t index) const {
  const float clearance = map_->clearance(index);
  const bool known = map_->known(index);
  if (clearance >= static_cast<float>(settings_.radius) && (known || settings_.cross_unknown)) return true;
  return clearance > 0 && clearance >= reduced_clearance_ && near_start(index);
}

float Passability::cost(std::size_t index) const {
  if (!passable(index)) return kImpassable;
  double cost = map_->known(index) ? 1.0 : std::max(1.0, settings_.unknown_cost);
  const double clearance = map_->clearance(index);
  if (clearance < settings_.comfort) {
    const double band = std::max(1e-6, settings_.comfort - settings_.radius);
    const double closeness = std::min(1.0, (settings_.comfort - clearance) / band);
    cost *= 1 + std::max(0.0, settings_.comfort_weight) * closeness * closeness;
  }
  return static_cast<float>(cost);
}

GridSearch::GridSearch(std::size_t most_cells, std::size_t most_poses)
    : nodes_(most_cells),
      heap_(most_cells),
      cells_(most_cells),
      corners_(most_poses),
      most_poses_(most_poses) {}

/// The free cell that is nearest to the goal, within the tolerance.
PlanProblem GridSearch::find_goal(const Pose2D& goal, double tolerance, Cell& found) const {
  const GridFrame& frame = map_->frame();
  const Cell wanted = frame.cell_of({goal.x, goal.y});
  if (!frame.contains(wanted)) return PlanProblem::GoalOutside;
  const auto reach_of_search = static_cast<int>(
      std::clamp(tolerance / frame.resolution, 0.0, static_cast<double>(ClearanceMap::kLongestSide)));
  double nearest = std::numeric_limits<double>::infinity();
  for (int dy = -reach_of_search; dy <= reach_of_search; ++dy) {
    for (int dx = -reach_of_search; dx <= reach_of_search; ++dx) {
      const Cell cell{wanted.x + dx, wanted.y + dy};
      const double distance = std::hypot(dx, dy);
      if (distance >= nearest || distance > reach_of_search || !frame.contains(cell)) continue;
      if (!passability_.passable(frame.index(cell))) continue;
      nearest = distance;
      found = cell;
    }
  }
  if (nearest <= reach_of_search) return PlanProblem::None;
  const std::size_t index = frame.index(wanted);
  return map_->known(index) ? PlanProblem::GoalOccupied : PlanProblem::GoalUnknown;
}

PlanProblem GridSearch::plan(const ClearanceMap& map, const Pose2D& start, const Pose2D& goal,
                             const PlanSettings& settings, messages::Path& path) {
  path.poses.clear();
  map_ = &map;
  const GridFrame& frame = map.frame();
  if (frame.size() == 0 || frame.size() > nodes_.size()) return PlanProblem::InvalidMap;
  const Cell first = frame.cell_of({start.x, start.y});
  if (!frame.contains(first)) return PlanProblem::StartOutside;
  if (map.clearance(frame.index(first)) == 0) return PlanProblem::StartOccupied;
  passability_ = Passability(map, settings, first);
  Cell last;
  if (const PlanProblem problem = find_goal(goal, settings.goal_tolerance, last);
      problem != PlanProblem::None)
    return problem;
  if (!search(first, last)) return PlanProblem::NoWay;

  std::size_t cells = 0;
  for (auto index = static_cast<std::uint32_t>(frame.index(last));; index = nodes_[index].parent) {
    cells_[cells++] = index;
    if (nodes_[index].parent == index) break;
  }
  std::size_t corners = 0;
  if (!shorten(cells, corners)) return PlanProblem::TooManyCorners;

  for (std::size_t i = 0; i < corners; ++i) {
    const Point place = frame.centre(frame.cell(cells_[corners_[i]]));
    path.poses.push_back({place.x, place.y, goal.theta});
  }
  path.poses.front() = {start.x, start.y, goal.theta};
  const bool exact = last == frame.cell_of({goal.x, goal.y});
  if (exact && corners == 1) path.poses.push_back(goal);
  if (exact) path.poses.back() = goal;
  for (std::size_t i = 0; i + 1 < path.poses.size(); ++i) {
    const Pose2D& next = path.poses[i + 1];
    path.poses[i].theta = std::atan2(next.y - path.poses[i].y, next.x - path.poses[i].x);
  }
  return PlanProblem::None;
}

bool GridSearch::search(Cell start, Cell goal) {
  const GridFrame& frame = map_->frame();
  std::fill_n(nodes_.begin(), frame.size(), Node{});
  heap_size_ = 0;
  const auto first = static_cast<std::uint32_t>(frame.index(start));
  const auto last = static_cast<std::uint32_t>(frame.index(goal));
  reach(first, first, 0, goal);
  while (heap_size_ > 0) {
    const std::uint32_t index = pop();
    if (index == last) return true;
    expand(index, goal);
  }
  return false;
}

void GridSearch::expand(std::uint32_t index, Cell goal) {
  constexpr std::array<Cell, 8> kNeighbours{
      {{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};
  const GridFrame& frame = map_->frame();
  const Cell cell = frame.cell(index);
  const float here = passability_.cost(index);
  const auto step = static_cast<float>(frame.resolution);
  for (const Cell offset : kNeighbours) {
    const Cell next{cell.x + offset.x, cell.y + offset.y};
    if (!frame.contains(next)) continue;
    const auto neighbour = static_cast<std::uint32_t>(frame.index(next));
    if (nodes_[neighbour].place == kClosed) continue;
    const float there = passability_.cost(neighbour);
    if (there == kImpassable) continue;
    const bool diagonal = offset.x != 0 && offset.y != 0;
    // A diagonal step touches the two cells beside it.
    if (diagonal && (!passability_.passable(frame.index({next.x, cell.y})) ||
                     !passability_.passable(frame.index({cell.x, next.y}))))
      continue;
    reach(neighbour, index, nodes_[index].cost + 0.5F * (here + there) * (diagonal ? kDiagonal : 1) * step,
          goal);
  }
}

void GridSearch::reach(std::uint32_t index, std::uint32_t parent, float cost, Cell goal) {
  Node& node = nodes_[index];
  if (node.place != kUnseen && node.cost <= cost) return;
  const GridFrame& frame = map_->frame();
  node.cost = cost;
  node.estimate = cost + octile(frame.cell(index), goal) * static_cast<float>(frame.resolution);
  node.parent = parent;
  if (node.place == kUnseen) put(heap_size_++, index);
  sift_up(static_cast<std::size_t>(node.place));
}

void GridSearch::put(std::size_t place, std::uint32_t index) {
  heap_[place] = index;
  nodes_[index].place = static_cast<std::int32_t>(place);
}

void GridSearch::sift_up(std::size_t place) {
  const std::uint32_t moving = heap_[place];
  while (place > 0) {
    const std::size_t above = (place - 1) / 2;
    if (nodes_[heap_[above]].estimate <= nodes_[moving].estimate) break;
    put(place, heap_[above]);
    place = above;
  }
  put(place, moving);
}

void GridSearch::sift_down(std::size_t place) {
  const std::uint32_t moving = heap_[place];
  for (;;) {
    std::size_t below = 2 * place + 1;
    if (below >= heap_size_) break;
    if (below + 1 < heap_size_ && nodes_[heap_[below + 1]].estimate < nodes_[heap_[below]].estimate) ++below;
    if (nodes_[moving].estimate <= nodes_[heap_[below]].estimate) break;
    put(place, heap_[below]);
    place = below;
  }
  put(place, moving);
}

std::uint32_t GridSearch::pop() {
  const std::uint32_t best = heap_[0];
  nodes_[best].place = kClosed;
  if (--heap_size_ > 0) {
    put(0, heap_[heap_size_]);
    sift_down(0);
  }
  return best;
}

/// Keeps the cells of the path that are its corners, from the start to the goal; false if there are too many.
bool GridSearch::shorten(std::size_t cells, std::size_t& corners) {
  constexpr double kRounding = 1e-3;
  const GridFrame& frame = map_->frame();
  const auto place = [&](std::size_t i) { return frame.centre(frame.cell(cells_[i])); };
  const auto cost = [&](std::size_t i) { return double{nodes_[cells_[i]].cost}; };
  std::size_t anchor = cells - 1;  // cells_ begins with the goal
  corners = 0;
  corners_[corners++] = static_cast<std::uint32_t>(anchor);
  while (anchor > 0) {
    std::size_t next = anchor - 1;
    while (next > 0) {
      const double replaced = cost(next - 1) - cost(anchor) + kRounding;
      if (cost_along(place(anchor), place(next - 1), replaced) > replaced) break;
      --next;
    }
    if (corners == most_poses_) return false;
    corners_[corners++] = static_cast<std::uint32_t>(next);
    anchor = next;
  }
  return true;
}

/// Stops counting above `limit`.
double GridSearch::cost_along(Point from, Point to, double limit) const {
  const GridFrame& frame = map_->frame();
  double sum = 0;
  traverse(frame, from, to, [&](Cell cell, double length) {
    const std::size_t index = frame.index(cell);
    if (passability_.passable(index))
      sum += length * passability_.cost(index);
    else
      sum = std::numeric_limits<double>::infinity();
    return sum <= limit;
  });
  return sum;
}

}  // namespace navigation
