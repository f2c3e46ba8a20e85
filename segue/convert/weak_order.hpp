// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace segue::convert {

/// The vertices of a directed graph in an order in which every backward edge leads to the head of a loop that
/// contains its origin. Loops are nested or disjoint.
struct WeakOrder {
  std::vector<std::uint32_t> vertices;  ///< those reachable from `start`, which is the first
  std::vector<std::uint32_t> end;    ///< by place: for heads of loops the place after the loop, otherwise 0
  std::vector<std::uint32_t> place;  ///< by vertex; kUnreached if it is not reachable
  static constexpr std::uint32_t kUnreached = static_cast<std::uint32_t>(-1);
};

/// A weak topological order (F. Bourdoncle, "Efficient chaotic iteration strategies with widenings", 1993) by
/// recursive strongly connected components. Time grows with the edges times the depth of loops.
WeakOrder weak_order(const std::vector<std::vector<std::uint32_t>>& successors, std::uint32_t start);

}  // namespace segue::convert
