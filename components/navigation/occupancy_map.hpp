// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "grid.hpp"

#include "../messages/sensors.hpp"

#include <cstdint>
#include <vector>

namespace navigation {

/// How much a measurement says about a cell, as log odds.
struct SensorModel {
  double hit = 0.85;         ///< added to the cell in which a beam ended
  double miss = -0.4;        ///< added to cells that a beam has crossed
  double maximum = 4.0;      ///< no cell is surer than this, so that what moves is forgotten
  double longest_beam = 10;  ///< m; what lies farther away is not entered
};

/// A map of what is occupied, made of laser scans (Moravec and Elfes 1985; Thrun, Burgard and Fox,
/// "Probabilistic Robotics", chapter 9). The constructor allocates, nothing else does. One thread at a time.
class OccupancyMap {
 public:
  explicit OccupancyMap(const GridFrame& frame, const SensorModel& model = {});

  [[nodiscard]] const GridFrame& frame() const { return frame_; }
  /// Forgets everything.
  void clear();
  /// Enters a scan that was taken at `sensor`. A cell takes one measurement of each scan: a cell in which a
  /// beam ended is not emptied by another beam that grazes it. Beams shorter than the scanner's minimum are
  /// ignored; those that met nothing empty the cells up to the shortest of the maximum ranges.
  void integrate(const messages::LaserScan& scan, const Pose2D& sensor);
  /// Percent, or -1 for cells that nothing is known of or that lie outside.
  [[nodiscard]] std::int8_t occupancy(Cell cell) const;
  /// Sets all fields but the time. Allocates if `grid` never had that many cells.
  void write_to(messages::OccupancyGrid& grid) const;

 private:
  template <class Visit>
  void for_each_beam(const messages::LaserScan& scan, const Pose2D& sensor, Visit visit) const;
  void add(Cell cell, int change);

  GridFrame frame_;
  int hit_;  ///< log odds, all in hundredths
  int miss_;
  int maximum_;
  double longest_beam_;
  std::vector<std::int16_t> log_odds_;  ///< hundredths, or kUnknown
  std::vector<std::uint32_t> scan_of_;  ///< the last scan that each cell took a measurement of
  std::vector<std::int8_t> percent_;    ///< of log odds from -maximum_ to maximum_
  std::uint32_t scan_ = 0;
};

}  // namespace navigation
