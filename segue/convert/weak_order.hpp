// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace segue::convert {

/// A directed graph's vertices in an order in which every edge that leads back leads to the head of a loop
/// around where it comes from. Loops nest, and lie side by side.
struct WeakOrder {
  std::vector<std::uint32_t> vertices;  ///< those that `start` leads to, the start first
  std::vector<std::uint32_t> end;       ///< by place: heads of loops: the place behind the loop; others: 0
  std::vector<std::uint32_t> place;     ///< by vertex; kUnreached where nothing leads
  static constexpr std::uint32_t kUnreached = static_cast<std::uint32_t>(-1);
};

/// A weak topological order (F. Bourdoncle, "Efficient chaotic iteration strategies with widenings", 1993) by
/// strongly connected components within components. Time grows with edges times the depth of loops.
WeakOrder weak_order(const std::vector<std::vector<std::uint32_t>>& successors, std::uint32_t start);

}  // namespace segue::convert
