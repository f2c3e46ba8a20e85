// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pose2d.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>

/// Where the cells of a grid lie, and which of them a straight line crosses. Real-time safe; any thread.
namespace navigation {

struct Cell {
  int x = 0;
  int y = 0;
  friend bool operator==(const Cell&, const Cell&) = default;
};

struct GridFrame {
  double resolution = 0.05;  ///< m, side of a cell
  double x = 0;              ///< m, of the corner with the smallest coordinates
  double y = 0;
  int width = 0;   ///< cells in a row
  int height = 0;  ///< rows

  friend bool operator==(const GridFrame&, const GridFrame&) = default;
  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  [[nodiscard]] bool contains(Cell cell) const {
    return cell.x >= 0 && cell.y >= 0 && cell.x < width && cell.y < height;
  }
  /// Requires contains().
  [[nodiscard]] std::size_t index(Cell cell) const {
    return static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(cell.x);
  }
  [[nodiscard]] Cell cell(std::size_t index) const {
    const auto columns = static_cast<std::size_t>(width);
    return {static_cast<int>(index % columns), static_cast<int>(index / columns)};
  }
  /// The cell around a point, which may lie outside of the grid.
  [[nodiscard]] Cell cell_of(Point point) const {
    return {bounded((point.x - x) / resolution), bounded((point.y - y) / resolution)};
  }
  [[nodiscard]] Point centre(Cell cell) const {
    return {x + (cell.x + 0.5) * resolution, y + (cell.y + 0.5) * resolution};
  }

 private:
  /// Coordinates that are not numbers, or too far away for an int, lie outside of every grid.
  static int bounded(double coordinate) {
    constexpr double kFar = 1e8;
    const double cell = std::floor(coordinate);
    if (!(cell > -kFar)) return -static_cast<int>(kFar);
    return cell < kFar ? static_cast<int>(cell) : static_cast<int>(kFar);
  }
};

inline GridFrame frame_of(const messages::OccupancyGrid& grid) {
  return {grid.resolution, grid.x, grid.y, static_cast<int>(grid.width), static_cast<int>(grid.height)};
}

/// Visits the cells that the line from `from` to `to` crosses, in their order, first and last included, until
/// `visit(cell, metres within the cell)` returns false; whether it never did. (Amanatides and Woo, "A fast
/// voxel traversal algorithm for ray tracing", 1987.)
template <class Visit>
bool traverse(const GridFrame& frame, Point from, Point to, Visit visit) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  struct Axis {
    int remaining;  ///< cells still to be entered along this axis
    int step;
    double next;    ///< share of the line at which the next cell begins
    double stride;  ///< share of the line from cell to cell
  };
  Cell cell = frame.cell_of(from);
  const Cell last = frame.cell_of(to);
  const auto axis = [&](int first_cell, int last_cell, double start, double way, double corner) {
    if (first_cell == last_cell) return Axis{0, 0, kNever, kNever};
    const int step = last_cell > first_cell ? 1 : -1;
    const double border = corner + frame.resolution * (first_cell + (step > 0 ? 1 : 0));
    return Axis{std::abs(last_cell - first_cell), step, (border - start) / way,
                frame.resolution / std::abs(way)};
  };
  Axis across = axis(cell.x, last.x, from.x, to.x - from.x, frame.x);
  Axis along = axis(cell.y, last.y, from.y, to.y - from.y, frame.y);
  const double length = std::hypot(to.x - from.x, to.y - from.y);
  double entered = 0;
  for (;;) {
    const bool turn_x = across.next < along.next;
    Axis& axis_of_step = turn_x ? across : along;
    const double left = std::clamp(axis_of_step.next, entered, 1.0);
    if (!visit(cell, (left - entered) * length)) return false;
    if (axis_of_step.remaining == 0) return true;
    entered = left;
    (turn_x ? cell.x : cell.y) += axis_of_step.step;
    axis_of_step.next = --axis_of_step.remaining > 0 ? axis_of_step.next + axis_of_step.stride : kNever;
  }
}

}  // namespace navigation
