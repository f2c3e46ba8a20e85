// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "clearance_map.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace navigation {

struct FrontierSettings {
  double radius = 0.3;        ///< m; no centre of an occupied cell comes closer to the vehicle
  double smallest = 0.4;      ///< m; shorter frontiers are not worth a drive
  double size_weight = 0.5;   ///< metres of way that a metre of frontier is worth
  double visit_radius = 0.3;  ///< m; this close to its goal, a frontier has been visited
};

struct Frontier {
  Pose2D goal;          ///< a cell of the frontier that the vehicle can reach; it looks at the unknown there
  double length = 0;    ///< m
  double distance = 0;  ///< m of way to the goal
};

/// Finds borders between free and unknown cells (Yamauchi, "A frontier-based approach for autonomous
/// exploration", 1997) that a vehicle can reach, and remembers which ones it has visited or given up. The
/// constructor allocates, nothing else does. One thread at a time.
class FrontierSearch {
 public:
  explicit FrontierSearch(std::size_t most_cells);

  /// The frontier with the least distance less size_weight times length; nothing if none is left. Does not
  /// offer frontiers close to places that were given up. The map must not have more cells than the
  /// constructor was told.
  std::optional<Frontier> next(const ClearanceMap& map, const Pose2D& vehicle,
                               const FrontierSettings& settings);
  /// Whether unknown cells adjoin free ones within visit_radius of a place, so that it is still worth a
  /// drive.
  [[nodiscard]] bool worth_while(const ClearanceMap& map, const Pose2D& place,
                                 const FrontierSettings& settings) const;
  /// Frontiers whose goals are closer than visit_radius to this place are not offered any more. The oldest of
  /// more than 256 such places are forgotten.
  void give_up(const Pose2D& place);
  /// Forgets the places that were given up.
  void reset() { given_up_count_ = 0; }
  /// Frontiers that the last next() found, the chosen one included.
  [[nodiscard]] std::size_t found() const { return found_; }

 private:
  static constexpr std::size_t kMostGivenUp = 256;
  void measure_ways(const ClearanceMap& map, Cell start, double radius);
  [[nodiscard]] bool is_frontier(const ClearanceMap& map, std::size_t index) const;
  [[nodiscard]] bool passable(const ClearanceMap& map, std::size_t index, double radius) const;
  std::size_t collect(const ClearanceMap& map, std::size_t seed);
  [[nodiscard]] Frontier describe(const ClearanceMap& map, std::size_t members) const;
  [[nodiscard]] bool was_given_up(const Pose2D& goal, double radius) const;

  std::vector<float> way_;              ///< cells from the vehicle; negative: not reached
  std::vector<std::uint8_t> taken_;     ///< belongs to a cluster already
  std::vector<std::uint32_t> reached_;  ///< cells in the order of their ways
  std::vector<std::uint32_t> members_;  ///< of one cluster
  std::size_t reached_count_ = 0;
  std::array<Pose2D, kMostGivenUp> given_up_{};
  std::size_t given_up_count_ = 0;
  std::size_t found_ = 0;
};

}  // namespace navigation
