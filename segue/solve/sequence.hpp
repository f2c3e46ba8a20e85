// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/solve/hash_index.hpp>

#include <vector>

namespace segue::solve::detail {

/// `before` must come before `after`.
struct Edge {
  int before;
  int after;
};

/// For every node the nodes before it, in one block of memory.
class Predecessors {
 public:
  Predecessors(int nodes, const std::vector<Edge>& edges);
  [[nodiscard]] const int* begin(int node) const { return before_.data() + start(node); }
  [[nodiscard]] const int* end(int node) const { return before_.data() + start(node + 1); }
  [[nodiscard]] int start(int node) const { return starts_[as_index(node)]; }
  /// Counted over all nodes; start(node) is the first of a node's.
  [[nodiscard]] int at(int place) const { return before_[as_index(place)]; }

 private:
  std::vector<int> starts_;
  std::vector<int> before_;
};

/// An order of nodes 0 .. n-1 in which each node comes after those before it. Nodes that a cycle joins are
/// one group and follow each other by number.
struct Sequence {
  std::vector<int> nodes;
  std::vector<int> group_of;  ///< per node
};
Sequence sequence(int nodes, const std::vector<Edge>& edges);

}  // namespace segue::solve::detail
