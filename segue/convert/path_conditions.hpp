// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_network/task_network.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace segue::convert {

/// A condition: the branch ends with that outcome, and so do the enclosing branches with theirs. Without a
/// branch: always true.
struct BranchEdge {
  std::uint32_t branch = task_network::kNone;
  task_network::OutcomeId outcome{};
  [[nodiscard]] bool always() const { return branch == task_network::kNone; }
  friend bool operator==(const BranchEdge&, const BranchEdge&) = default;
};

/// The ways in which a branch may end.
struct BranchEnds {
  std::vector<task_network::OutcomeId> outcomes;
  std::vector<double> likelihoods;  ///< by outcome, between 0 and 1
};

/// The branches of a plan: nodes whose outcomes lead to different places. They form a tree, since each lies
/// on one edge of another. A place that several edges lead to has a branch of its own, a join. Decisions are
/// taken into account as they become known. Not thread safe.
class PathConditions {
 public:
  /// Adds a branch: `node` lies on `around` and ends in one of `ends`. If an outcome is expected, the others
  /// are not.
  std::uint32_t add(task_network::NodeId node, BranchEdge around, std::shared_ptr<const BranchEnds> ends,
                    std::optional<task_network::OutcomeId> expected);
  /// Adds a join, which lies on `around`: `node` ends with `reached` if one of `edges` is on the path.
  BranchEdge add_join(task_network::NodeId node, BranchEdge around, std::vector<BranchEdge> edges,
                      task_network::OutcomeId reached, task_network::OutcomeId missed);
  void decide(task_network::NodeId node, task_network::OutcomeId outcome);

  /// How many branches there are; they are numbered from 0, each after those around it.
  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(branches_.size()); }
  [[nodiscard]] BranchEdge around(std::uint32_t branch) const { return branches_[branch].around; }
  /// The edges that a join stands for; empty for other branches.
  [[nodiscard]] const std::vector<BranchEdge>& means(std::uint32_t branch) const {
    return branches_[branch].meaning;
  }
  /// The outcome of a join where one of its edges is on the path.
  [[nodiscard]] task_network::OutcomeId reached(std::uint32_t branch) const {
    return branches_[branch].ends->outcomes.front();
  }
  [[nodiscard]] task_network::NodeId node(BranchEdge edge) const { return branches_[edge.branch].node; }
  /// The edge without decided branches; nothing if it is off the path.
  std::optional<BranchEdge> live(BranchEdge edge) { return edge.always() ? edge : live_within(edge); }
  /// Whether what is decided so far puts the edge on the path for good.
  bool certain(BranchEdge edge) {
    const auto known = live(edge);
    return known && known->always();
  }
  /// Whether the edge is off the path, also where a join on the way to it has not ended yet but must end as
  /// missed.
  bool off_path(BranchEdge edge);
  /// Whether the tree proves that `outer` is on the path whenever `inner` is.
  bool implies(BranchEdge inner, BranchEdge outer);
  /// Whether the tree proves that they cannot both be on the path.
  bool exclude(BranchEdge a, BranchEdge b);
  /// The edge that is on the path exactly if one of these is; nothing where there is none or it takes a join.
  /// Requires that they are live.
  std::optional<BranchEdge> merged(std::vector<BranchEdge> edges);
  /// The innermost edge that both imply.
  BranchEdge common(BranchEdge a, BranchEdge b);
  /// Whether all branches between `outer` and `edge` are taken as expected.
  bool expected(BranchEdge edge, BranchEdge outer);
  /// The innermost conditions of the edge, for a node that lies on it.
  [[nodiscard]] std::vector<task_network::Condition> conditions(BranchEdge edge);

 private:
  struct Branch {
    task_network::NodeId node{};
    BranchEdge around;
    std::uint32_t depth = 0;
    std::shared_ptr<const BranchEnds> ends;  ///< many branches have the same
    std::vector<BranchEdge> meaning;         ///< joins: the edges
    double reaches = 0;                      ///< joins: the likelihood that one of these is on the path
    bool narrows = false;                    ///< joins: an edge may be on the path although `around` is not
    std::optional<task_network::OutcomeId> decided;
    std::optional<task_network::OutcomeId> expected;
    bool dead = false;
    std::uint64_t live_at = 0;  ///< changes_ when the edge that it lies on was live, and undecided, last
  };
  [[nodiscard]] std::uint32_t depth(BranchEdge edge) const {
    return edge.always() ? 0 : branches_[edge.branch].depth;
  }
  std::optional<BranchEdge> live_within(BranchEdge edge);
  [[nodiscard]] double likelihood(BranchEdge edge) const;
  [[nodiscard]] double likelihood(BranchEdge edge, BranchEdge outer) const;
  bool reduce(std::vector<BranchEdge>& edges);
  bool expand(std::vector<BranchEdge>& edges);

  std::vector<Branch> branches_;
  std::shared_ptr<const BranchEnds> join_ends_;  ///< of all joins, without likelihoods
  std::uint64_t changes_ = 1;  ///< how often branches were decided or turned out to be off the path
  std::vector<std::uint32_t> by_node_;
  std::vector<std::uint32_t> way_;  ///< of live()
};

}  // namespace segue::convert
