// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/convert/path_conditions.hpp>

#include <cstdint>
#include <vector>

namespace segue::convert {

/// The tree of a plan's branches as it is at one time, for many questions about it: each takes time that is
/// logarithmic in its depth. (E. W. Myers, "An applicative random-access stack", 1983: each branch knows,
/// besides the edge that it lies on, one that is further out.) Thread safe.
class PathIndex {
 public:
  explicit PathIndex(const PathConditions& paths);

  /// Whether the tree proves that `outer` is on the path whenever `inner` is.
  [[nodiscard]] bool implies(BranchEdge inner, BranchEdge outer) const;
  /// Whether the tree proves that they cannot both be on the path. It takes into account which edges joins
  /// stand for, as far as that is found in a limited number of steps.
  [[nodiscard]] bool never_meet(BranchEdge a, BranchEdge b) const;

 private:
  struct Place {
    std::uint32_t depth = 0;
    BranchEdge around;                  ///< the edge that the branch lies on
    BranchEdge further;                 ///< that edge, or one around it
    BranchEdge join;                    ///< the innermost edge around the branch that is a join's
    std::vector<BranchEdge> means;      ///< of a join: the edges that it stands for
    task_network::OutcomeId reached{};  ///< of a join: its outcome where one of them is on the path
  };
  [[nodiscard]] std::uint32_t depth(BranchEdge edge) const {
    return edge.always() ? 0 : places_[edge.branch].depth;
  }
  /// The edge itself or the one around it that has that depth.
  [[nodiscard]] BranchEdge at_depth(BranchEdge edge, std::uint32_t depth) const;
  [[nodiscard]] bool differ(BranchEdge a, BranchEdge b) const;
  [[nodiscard]] bool never_meet(BranchEdge a, BranchEdge b, int& budget) const;
  [[nodiscard]] bool is_join(BranchEdge edge) const;

  std::vector<Place> places_;  ///< by branch
};

}  // namespace segue::convert
