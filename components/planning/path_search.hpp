// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

namespace planning {

using Positions = std::vector<double>;

/// The space that is searched: joints within their limits, of which some configurations are free.
struct SearchSpace {
  std::vector<std::pair<double, double>> limits;  ///< lower and upper of each joint
  std::function<bool(const Positions& positions)> is_free;
  double resolution = 0.02;  ///< rad; between configurations that are checked on a line
};

struct SearchBudget {
  std::uint32_t steps = 1000;  ///< growing the trees and shortening a path
  std::uint64_t seed = 1;
  bool first = false;  ///< the first path will do
};

/// How long it takes if each joint moves by at most 1 a second; infinite where there are no points.
double cost_of(const std::vector<Positions>& path);

/// A path from `start` to `goal` over points between which straight lines are free: by RRT-Connect (Kuffner
/// and LaValle, ICRA 2000) from OMPL, shortened by cutting corners, again and again until the budget is used
/// up; the cheapest one that was found. Nothing if `start` or `goal` is not free or none was found. The same
/// arguments give the same path. Any thread; searches in one process take turns, since OMPL's random numbers
/// have one seed for all.
std::optional<std::vector<Positions>> find_path(const SearchSpace& space, const Positions& start,
                                                const Positions& goal, const SearchBudget& budget);

}  // namespace planning
