// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "clearance_map.hpp"
#include "types.hpp"

#include <cstdint>
#include <string_view>
#include <vector>

namespace navigation {

/// A sentence for people: what stands in the way, and what to do.
[[nodiscard]] std::string_view explain(PlanProblem problem);

struct PlanSettings {
  double radius = 0.3;        ///< m; no centre of an occupied cell comes closer to the path
  double comfort = 0.6;       ///< m; distance from obstacles from which on a detour is not worth while
  double comfort_weight = 3;  ///< how much longer a way may be that stays clear of obstacles
  bool cross_unknown = true;
  double unknown_cost = 2;    ///< of a metre in unknown cells, compared with one in known cells
  double goal_tolerance = 0;  ///< m; how far from the goal the path may end where the goal is not free
};

/// Which cells a vehicle can cross. Close to where it stands it may be as near to obstacles as it already is,
/// so that it finds the way out of a place that the map calls too narrow.
class Passability {
 public:
  Passability() = default;
  Passability(const ClearanceMap& map, const PlanSettings& settings, Cell start);
  /// Cost of a metre in this cell, at least 1; infinite where it cannot be crossed.
  [[nodiscard]] float cost(std::size_t index) const;
  [[nodiscard]] bool passable(std::size_t index) const;

 private:
  [[nodiscard]] bool near_start(std::size_t index) const;
  const ClearanceMap* map_ = nullptr;
  PlanSettings settings_;
  Cell start_;
  double exempt_cells_ = 0;  ///< how far around the start the reduced clearance suffices
  float reduced_clearance_ = 0;
};

/// Shortest paths on grids: A* (Hart, Nilsson and Raphael 1968) on eight neighbours, then shortcuts along
/// straight lines that cost no more than what they replace. The constructor allocates, nothing else does. One
/// thread at a time.
class GridSearch {
 public:
  /// Requires most_poses >= 2.
  GridSearch(std::size_t most_cells, std::size_t most_poses);

  /// The path from start to goal: its first pose is the start's position, the last one the goal. Each pose
  /// looks towards the next one, the last one as the goal does. `path` is empty unless the result is None; it
  /// allocates if it never had as many poses. The map must not have more cells than the constructor was told.
  PlanProblem plan(const ClearanceMap& map, const Pose2D& start, const Pose2D& goal,
                   const PlanSettings& settings, messages::Path& path);

 private:
  struct Node {
    float cost = 0;      ///< of the best way from the start that was found so far
    float estimate = 0;  ///< of the whole path through this cell; the order of the heap
    std::uint32_t parent = 0;
    std::int32_t place = kUnseen;  ///< in the heap
  };
  static constexpr std::int32_t kUnseen = -1;
  static constexpr std::int32_t kClosed = -2;

  PlanProblem find_goal(const Pose2D& goal, double tolerance, Cell& found) const;
  bool search(Cell start, Cell goal);
  void expand(std::uint32_t index, Cell goal);
  void reach(std::uint32_t index, std::uint32_t parent, float cost, Cell goal);
  void sift_up(std::size_t place);
  void sift_down(std::size_t place);
  std::uint32_t pop();
  void put(std::size_t place, std::uint32_t index);
  bool shorten(std::size_t cells, std::size_t& corners);
  [[nodiscard]] double cost_along(Point from, Point to, double limit) const;

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> heap_;
  std::size_t heap_size_ = 0;
  std::vector<std::uint32_t> cells_;    ///< of the path, from the goal to the start
  std::vector<std::uint32_t> corners_;  ///< indices into cells_
  std::size_t most_poses_;
  const ClearanceMap* map_ = nullptr;
  Passability passability_;
};

}  // namespace navigation
