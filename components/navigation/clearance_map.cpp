// SPDX-License-Identifier: Apache-2.0
#include "clearance_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace navigation {
namespace {

/// In cells; larger than every distance in a grid, and its square is exact in a double.
constexpr float kNoneInColumn = 1e6F;

}  // namespace

ClearanceMap::ClearanceMap(std::size_t most_cells)
    : frame_{.width = 0, .height = 0},
      clearance_(most_cells),
      known_(most_cells),
      square_(kLongestSide),
      border_(kLongestSide + 1),
      vertex_(kLongestSide) {}

bool ClearanceMap::fits(const messages::OccupancyGrid& grid) const {
  const auto longest = static_cast<std::uint32_t>(kLongestSide);
  return grid.width > 0 && grid.height > 0 && grid.width <= longest && grid.height <= longest &&
         grid.resolution > 0 && std::isfinite(grid.resolution) && std::isfinite(grid.x) &&
         std::isfinite(grid.y) && grid.cells.size() == std::size_t{grid.width} * std::size_t{grid.height} &&
         grid.cells.size() <= clearance_.size();
}

void ClearanceMap::update(const messages::OccupancyGrid& grid) {
  frame_ = frame_of(grid);
  for (std::size_t i = 0; i < grid.cells.size(); ++i) {
    known_[i] = grid.cells[i] >= 0 ? 1 : 0;
    clearance_[i] = grid.cells[i] >= kOccupiedFrom ? 0 : kNoneInColumn;
  }
  measure_columns();
  for (int row = 0; row < frame_.height; ++row)
    measure_row(row);
}

/// The distance to the nearest occupied cell of the same column.
void ClearanceMap::measure_columns() {
  const auto width = static_cast<std::size_t>(frame_.width);
  const std::size_t cells = frame_.size();
  for (std::size_t i = width; i < cells; ++i)
    clearance_[i] = std::min(clearance_[i], clearance_[i - width] + 1);
  for (std::size_t i = cells - width; i-- > 0;)
    clearance_[i] = std::min(clearance_[i], clearance_[i + width] + 1);
}

/// min over all columns u of (column - u)^2 + square(u): the lowest of the parabolas whose vertices are
/// there.
void ClearanceMap::measure_row(int row) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  const auto width = static_cast<std::size_t>(frame_.width);
  float* const distance = clearance_.data() + static_cast<std::size_t>(row) * width;
  std::size_t count = 0;
  for (std::size_t column = 0; column < width; ++column) {
    const double near = std::min(distance[column], kNoneInColumn);
    square_[column] = near * near;
    const auto place = static_cast<double>(column);
    const auto crossing = [&](int other) {
      return (square_[column] + place * place - square_[static_cast<std::size_t>(other)] -
              static_cast<double>(other) * other) /
             (2 * (place - other));
    };
    while (count > 0 && crossing(vertex_[count - 1]) <= border_[count - 1])
      --count;
    border_[count] = count == 0 ? -kInfinite : crossing(vertex_[count - 1]);
    vertex_[count] = static_cast<int>(column);
    ++count;
    border_[count] = kInfinite;
  }
  std::size_t lowest = 0;
  for (std::size_t column = 0; column < width; ++column) {
    const auto place = static_cast<double>(column);
    while (border_[lowest + 1] < place)
      ++lowest;
    const double aside = place - vertex_[lowest];
    const double square = aside * aside + square_[static_cast<std::size_t>(vertex_[lowest])];
    const bool none = square >= double{kNoneInColumn} * double{kNoneInColumn};
    distance[column] = none ? kNothingNear : static_cast<float>(frame_.resolution * std::sqrt(square));
  }
}

double ClearanceMap::clearance_at(Point point) const {
  const double half = 0.5 * frame_.resolution;
  const Cell cell = frame_.cell_of({point.x - half, point.y - half});
  if (!frame_.contains(cell) || !frame_.contains({cell.x + 1, cell.y + 1})) return kNothingNear;
  const Point centre = frame_.centre(cell);
  const double right = (point.x - centre.x) / frame_.resolution;
  const double up = (point.y - centre.y) / frame_.resolution;
  const std::size_t index = frame_.index(cell);
  const std::size_t above = frame_.index({cell.x, cell.y + 1});
  const double below = std::lerp(double{clearance_[index]}, double{clearance_[index + 1]}, right);
  return std::lerp(below, std::lerp(double{clearance_[above]}, double{clearance_[above + 1]}, right), up);
}

}  // namespace navigation
