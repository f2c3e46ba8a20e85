// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "grid.hpp"

#include <cstdint>
#include <vector>

namespace navigation {

/// How far each cell of a map is from what is occupied (exact Euclidean distance transform: Felzenszwalb and
/// Huttenlocher, "Distance transforms of sampled functions", 2012). The constructor allocates, nothing else
/// does. One thread at a time.
class ClearanceMap {
 public:
  static constexpr int kLongestSide = 8192;    // cells
  static constexpr float kNothingNear = 1e9F;  // m
  static constexpr int kOccupiedFrom = 60;     // percent

  explicit ClearanceMap(std::size_t most_cells);

  /// Whether update() can take a grid: its fields agree with each other and it is not too large.
  [[nodiscard]] bool fits(const messages::OccupancyGrid& grid) const;
  /// Requires fits().
  void update(const messages::OccupancyGrid& grid);

  /// The frame of the grid of the last update(); width and height are 0 before the first.
  [[nodiscard]] const GridFrame& frame() const { return frame_; }
  /// Metres from the centre of the cell to that of the nearest occupied one; 0: occupied; kNothingNear where
  /// no cell of the map is occupied.
  [[nodiscard]] float clearance(std::size_t index) const { return clearance_[index]; }
  /// The clearance in metres at a point between the centres of cells, interpolated; kNothingNear outside of
  /// the map and at its edge.
  [[nodiscard]] double clearance_at(Point point) const;
  [[nodiscard]] bool known(std::size_t index) const { return known_[index] != 0; }
  [[nodiscard]] std::size_t most_cells() const { return clearance_.size(); }

 private:
  void measure_columns();
  void measure_row(int row);

  GridFrame frame_;
  std::vector<float> clearance_;
  std::vector<std::uint8_t> known_;
  /// Memory for the work on one row: the squared distances in columns, and the lower envelope of parabolas.
  std::vector<double> square_;
  std::vector<double> border_;
  std::vector<int> vertex_;
};

}  // namespace navigation
