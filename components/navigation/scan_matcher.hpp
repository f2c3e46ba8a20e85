// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "clearance_map.hpp"

#include "../messages/sensors.hpp"

#include <optional>
#include <vector>

namespace navigation {

struct MatchSettings {
  double window = 0.25;        ///< m to either side of the guess that is searched
  double angle_window = 0.15;  ///< rad to either side of the guess that is searched
  double sharpness = 0.1;      ///< m: a beam that ends this far from what is occupied counts half
  double guess_weight = 0.05;  ///< how much worse a pose at the edge of the window is, so that it is not left
                               ///< for nothing, as along a corridor
  double longest_beam = 10;    ///< m; beams that end farther away are not used
};

struct Match {
  Pose2D pose;       ///< of the sensor
  double score = 0;  ///< 1: all beams end at occupied cells; 0: none does
};

/// Finds the pose at which a scan fits a map: tries all poses around a guess, then refines the best (Olson,
/// "Real-time correlative scan matching", 2009, with a distance field in place of the lookup tables). The
/// constructor allocates, nothing else does. One thread at a time.
class ScanMatcher {
 public:
  explicit ScanMatcher(std::size_t most_points);

  /// The pose of the sensor at which the scan was taken, close to `guess`. Nothing if fewer than ten beams
  /// can be used. It uses every second, third ... beam of scans with more beams than the constructor was
  /// told.
  std::optional<Match> match(const ClearanceMap& map, const messages::LaserScan& scan, const Pose2D& guess,
                             const MatchSettings& settings);

 private:
  void take(const messages::LaserScan& scan, double longest);
  void turn(double theta);
  [[nodiscard]] double coarse_score(const ClearanceMap& map, Point place, double sharpness) const;
  [[nodiscard]] double fine_score(const ClearanceMap& map, Point place, double sharpness) const;
  [[nodiscard]] Pose2D search(const ClearanceMap& map, const Pose2D& guess, const MatchSettings& settings);
  [[nodiscard]] Match refine(const ClearanceMap& map, const Pose2D& guess, Pose2D pose,
                             const MatchSettings& settings);

  std::vector<Point> points_;  ///< in the frame of the sensor
  std::vector<Point> turned_;  ///< in its place, but with the directions of the map
  std::size_t count_ = 0;
};

}  // namespace navigation
