// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/path_index.hpp>

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace segue::convert {
namespace {

using task_network::NodeId;
using task_network::OutcomeId;

constexpr OutcomeId kLeft{3};
constexpr OutcomeId kRight{4};

/// Branches with two outcomes, each on one edge of an earlier one or on none.
class TreeOfPaths {
 public:
  BranchEdge add(BranchEdge around, OutcomeId outcome = kLeft) {
    const NodeId node{paths_.size()};
    const auto ends = std::make_shared<BranchEnds>(BranchEnds{{kLeft, kRight}, {0.5, 0.5}});
    return {paths_.add(node, around, ends, std::nullopt), outcome};
  }
  BranchEdge join(BranchEdge around, std::vector<BranchEdge> edges) {
    return paths_.add_join(NodeId{paths_.size()}, around, std::move(edges), kLeft, kRight);
  }
  /// All edges around the edge, itself included, innermost first.
  [[nodiscard]] std::vector<BranchEdge> way(BranchEdge edge) const {
    std::vector<BranchEdge> way;
    for (; !edge.always(); edge = paths_.around(edge.branch))
      way.push_back(edge);
    return way;
  }
  [[nodiscard]] PathIndex index() const { return PathIndex(paths_); }

 private:
  PathConditions paths_;
};

BranchEdge other_way(BranchEdge edge) {
  return {edge.branch, edge.outcome == kLeft ? kRight : kLeft};
}

TEST(PathIndex, JoinsMeetNothingThatNoneOfTheirEdgesMeets) {
  TreeOfPaths tree;
  const BranchEdge first = tree.add({});
  const BranchEdge within = tree.add(first);
  const BranchEdge second = tree.add(other_way(first));
  const BranchEdge both = tree.join({}, {within, other_way(within)});
  const BranchEdge either = tree.join({}, {within, second});
  const BranchEdge within_both = tree.add(both);
  const PathIndex index = tree.index();
  EXPECT_TRUE(index.never_meet(both, second));
  EXPECT_FALSE(index.never_meet(either, second));
  EXPECT_TRUE(index.never_meet(within_both, second)) << "also what lies within the join";
}

TEST(PathIndex, AnEdgeImpliesItselfAndWhatIsAlwaysTrue) {
  TreeOfPaths tree;
  const BranchEdge edge = tree.add({});
  EXPECT_TRUE(tree.index().implies(edge, edge));
  EXPECT_TRUE(tree.index().implies(edge, {}));
  EXPECT_TRUE(tree.index().implies({}, {}));
  EXPECT_FALSE(tree.index().implies({}, edge));
}

RC_GTEST_PROP(PathIndex, AgreesWithTheWaysOutwards, ()) {
  TreeOfPaths tree;
  std::vector<BranchEdge> edges{{}};
  const auto branches = *rc::gen::inRange(1, 60);
  for (int i = 0; i < branches; ++i) {
    // Mostly deep trees.
    const auto back = std::min<std::size_t>(edges.size(), *rc::gen::inRange<std::size_t>(1, 6));
    const BranchEdge edge = tree.add(edges[edges.size() - back]);
    edges.push_back(edge);
    edges.push_back(other_way(edge));
  }
  const PathIndex index = tree.index();
  for (const BranchEdge a : edges) {
    const std::vector<BranchEdge> way = tree.way(a);
    for (const BranchEdge b : edges) {
      RC_ASSERT(index.implies(a, b) == (b.always() || std::ranges::find(way, b) != way.end()));
      const auto excluded = [&](BranchEdge edge) {
        return std::ranges::find(way, other_way(edge)) != way.end();
      };
      RC_ASSERT(index.never_meet(a, b) == std::ranges::any_of(tree.way(b), excluded));
    }
  }
}

}  // namespace
}  // namespace segue::convert
