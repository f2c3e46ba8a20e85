// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/solve/hash_index.hpp>

#include <vector>

namespace segue::solve::detail {

/// `before` must come before `after`.
struct OrderEdge {
  int before;
  int after;
};

/// The predecessors of every node, in one block of memory.
class Predecessors {
 public:
  Predecessors(int nodes, const std::vector<OrderEdge>& edges);
  [[nodiscard]] const int* begin(int node) const { return before_.data() + start(node); }
  [[nodiscard]] const int* end(int node) const { return before_.data() + start(node + 1); }
  [[nodiscard]] int start(int node) const { return starts_[as_index(node)]; }
  /// A predecessor by its position in the block; start(node) is the first one of `node`.
  [[nodiscard]] int at(int place) const { return before_[as_index(place)]; }

 private:
  std::vector<int> starts_;
  std::vector<int> before_;
};

/// A topological order of nodes 0 .. n-1. The nodes of a cycle form one group and are ordered by number.
struct GroupedOrder {
  std::vector<int> nodes;
  std::vector<int> group_of;  ///< by node
};
GroupedOrder sequence(int nodes, const std::vector<OrderEdge>& edges);

}  // namespace segue::solve::detail
