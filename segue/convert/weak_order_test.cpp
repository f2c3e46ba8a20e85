// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/weak_order.hpp>

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <numeric>

namespace segue::convert {
namespace {

using ::testing::ElementsAre;
using Graph = std::vector<std::vector<std::uint32_t>>;

TEST(WeakOrder, FollowsEdgesWhereThereAreNoLoops) {
  const WeakOrder order = weak_order({{1, 2}, {3}, {1}, {}}, 0);
  EXPECT_THAT(order.vertices, ElementsAre(0, 2, 1, 3));
  EXPECT_THAT(order.end, ElementsAre(0, 0, 0, 0));
}

TEST(WeakOrder, PutsALoopBeforeWhatComesBehindIt) {
  // 0 -> 1 -> 2 -> 1, and 1 leads out to 3.
  const WeakOrder order = weak_order({{1}, {3, 2}, {1}, {}}, 0);
  EXPECT_THAT(order.vertices, ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(order.end, ElementsAre(0, 3, 0, 0));
}

TEST(WeakOrder, NestsLoops) {
  // Bourdoncle's example: 1 2 (3 4 (5 6) 7) 8, from 0.
  const WeakOrder order = weak_order({{1}, {2, 7}, {3}, {4}, {5, 6}, {4, 6}, {2, 7}, {}}, 0);
  EXPECT_THAT(order.vertices, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
  EXPECT_THAT(order.end, ElementsAre(0, 0, 7, 0, 6, 0, 0, 0));
}

TEST(WeakOrder, ALoopOfOneAndWhatIsNeverReached) {
  const WeakOrder order = weak_order({{0}, {0}}, 0);
  EXPECT_THAT(order.vertices, ElementsAre(0));
  EXPECT_THAT(order.end, ElementsAre(1));
  EXPECT_EQ(order.place[1], WeakOrder::kUnreached);
}

TEST(WeakOrder, DepthCostsMemoryOnly) {
  Graph line(200'000);
  for (std::uint32_t i = 0; i + 1 < line.size(); ++i)
    line[i].push_back(i + 1);
  EXPECT_EQ(weak_order(line, 0).vertices.size(), line.size());
}

RC_GTEST_PROP(WeakOrder, EdgesBackLeadToHeadsOfLoopsAround, ()) {
  const auto size = *rc::gen::inRange<std::uint32_t>(1, 20);
  Graph graph(size);
  for (auto& successors : graph)
    successors = *rc::gen::container<std::vector<std::uint32_t>>(rc::gen::inRange<std::uint32_t>(0, size));
  const WeakOrder order = weak_order(graph, 0);
  for (std::uint32_t at = 0; at < order.vertices.size(); ++at) {
    RC_ASSERT(order.place[order.vertices[at]] == at);
    for (const std::uint32_t to : graph[order.vertices[at]]) {
      const std::uint32_t target = order.place[to];
      RC_ASSERT(target != WeakOrder::kUnreached);
      RC_ASSERT(target > at || (target <= at && at < order.end[target]));
    }
  }
}

}  // namespace
}  // namespace segue::convert
