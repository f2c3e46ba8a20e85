// SPDX-License-Identifier: Apache-2.0
#include <segue/task_network/resource_pool.hpp>

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include <map>
#include <optional>

namespace segue::task_network {
namespace {

using Claims = std::vector<Claim>;

Rank rank(std::uint32_t node) {
  return {0, 0, NodeId{node}};
}

class Pool : public testing::Test {
 protected:
  ResourceId add(const std::string& name, std::uint32_t count, bool varies = false) {
    const ResourceId id = table_.intern(name);
    table_[id].count = count;
    table_[id].varies = varies;
    return id;
  }
  std::vector<NodeId> granted() {
    std::vector<NodeId> nodes;
    pool().granted(nodes);
    return nodes;
  }
  ResourcePool& pool() {
    if (!pool_) pool_.emplace(table_);
    return *pool_;
  }
  ResourceTable table_;
  std::optional<ResourcePool> pool_;
};

TEST_F(Pool, GivesAllOrNothing) {
  const Claims first{{add("arm", 1)}};
  const Claims both{{add("arm", 1)}, {add("camera", 1)}};
  EXPECT_TRUE(pool().request(rank(0), first));
  EXPECT_FALSE(pool().request(rank(1), both));
  EXPECT_EQ(pool().free(*table_.find("camera")), 1U);
  pool().release(first, true);
  EXPECT_THAT(granted(), testing::ElementsAre(NodeId{1}));
}

TEST_F(Pool, BackfillsOnlyWhereItDelaysNobodyAhead) {
  const ResourceId arm = add("arm", 1);
  const ResourceId cells = add("cells", 4);
  const Claims holder{{arm}};
  const Claims ahead{{arm}, {cells, ResourceOp::Block, 3}};
  const Claims two{{cells, ResourceOp::Block, 2}};
  const Claims one{{cells}};
  EXPECT_TRUE(pool().request(rank(0), holder));
  EXPECT_FALSE(pool().request(rank(1), ahead));
  EXPECT_FALSE(pool().request(rank(2), two)) << "it would take a unit that node 1 waits for";
  EXPECT_FALSE(pool().request(rank(4), one)) << "node 2 is ahead";
  pool().withdraw(rank(2), two);
  EXPECT_THAT(granted(), testing::ElementsAre(NodeId{4}));
  pool().release(holder, true);
  EXPECT_THAT(granted(), testing::ElementsAre(NodeId{1}));
}

TEST_F(Pool, WhoComesEarlierInTheProgramGoesFirst) {
  const Claims arm{{add("arm", 1)}};
  EXPECT_TRUE(pool().request(rank(9), arm));
  for (const std::uint32_t node : {5U, 3U, 4U})
    EXPECT_FALSE(pool().request(rank(node), arm));
  pool().release(arm, true);
  EXPECT_THAT(granted(), testing::ElementsAre(NodeId{3}));
}

TEST_F(Pool, UnitsAreCreatedConsumedAndDeleted) {
  const ResourceId parts = add("parts", 1, true);
  const Claims create{{parts, ResourceOp::Create, 2}};
  const Claims consume{{parts, ResourceOp::Consume}};
  const Claims remove{{parts, ResourceOp::Delete}};
  EXPECT_TRUE(pool().request(rank(0), create));
  EXPECT_EQ(pool().total(parts), 1U) << "not before the node has ended";
  pool().release(create, true);
  EXPECT_EQ(pool().total(parts), 3U);
  EXPECT_TRUE(pool().request(rank(1), consume));
  EXPECT_EQ(pool().total(parts), 2U) << "at once";
  pool().release(consume, true);
  EXPECT_TRUE(pool().request(rank(2), remove));
  EXPECT_EQ(pool().total(parts), 2U);
  EXPECT_EQ(pool().free(parts), 1U);
  pool().release(remove, true);
  EXPECT_EQ(pool().total(parts), 1U);
  EXPECT_TRUE(pool().request(rank(3), remove));
  pool().release(remove, false);
  EXPECT_EQ(pool().free(parts), 1U) << "a node that failed deletes nothing";
}

TEST_F(Pool, NobodyTakesAwayWhatMustExist) {
  const ResourceId server = add("server", 1, true);
  const Claims exists{{server, ResourceOp::Exists}};
  const Claims remove{{server, ResourceOp::Delete}};
  EXPECT_TRUE(pool().request(rank(0), exists));
  EXPECT_FALSE(pool().request(rank(1), remove));
  pool().release(exists, true);
  EXPECT_THAT(granted(), testing::ElementsAre(NodeId{1}));
  pool().release(remove, true);
  EXPECT_FALSE(pool().request(rank(2), exists));
  ASSERT_NE(pool().obstacle(exists), nullptr);
}

TEST_F(Pool, AGroupKeepsItsUnitsFromFirstToLastMember) {
  const ResourceId arm = add("arm", 1);
  const std::vector<GroupLock> groups{{arm, 1, 2}};
  pool().take_groups(groups);
  const Claims member{{arm, ResourceOp::Block, 1, 0}};
  const Claims other{{arm}};
  EXPECT_TRUE(pool().request(rank(0), member));
  EXPECT_FALSE(pool().request(rank(1), member)) << "members exclude each other too";
  pool().release(member, true);
  pool().leave_group(0);
  EXPECT_THAT(granted(), testing::ElementsAre(NodeId{1}));
  EXPECT_FALSE(pool().request(rank(2), other));
  pool().release(member, true);
  EXPECT_THAT(granted(), testing::IsEmpty());
  pool().leave_group(0);
  EXPECT_THAT(granted(), testing::ElementsAre(NodeId{2}));
}

TEST_F(Pool, AGroupThatGrowsTakesItsUnitsAgain) {
  const ResourceId arm = add("arm", 1);
  pool().take_groups(std::vector<GroupLock>{{arm, 1, 1}});
  const Claims first{{arm, ResourceOp::Block, 1, 0}};
  const Claims member{{arm, ResourceOp::Exists, 1, 0}};
  EXPECT_TRUE(pool().request(rank(0), first));
  pool().release(first, true);
  pool().leave_group(0);
  pool().take_groups(std::vector<GroupLock>{{arm, 1, 2}});
  EXPECT_TRUE(pool().request(rank(1), member));
  EXPECT_FALSE(pool().request(rank(5), Claims{{arm}}));
  pool().release(member, true);
  pool().leave_group(0);
  EXPECT_THAT(granted(), testing::ElementsAre(NodeId{5}));
}

TEST_F(Pool, GrantsNoMoreThanALimitLeaves) {
  const ResourceId cells = add("cells", 4);
  const Claims one{{cells}};
  const Claims two{{cells, ResourceOp::Block, 2}};
  EXPECT_TRUE(pool().request(rank(0), two));
  pool().limit(cells, 1);
  EXPECT_EQ(pool().total(cells), 4U);
  EXPECT_FALSE(pool().shortage(two)) << "they are there";
  EXPECT_FALSE(pool().request(rank(1), one)) << "who holds more keeps them, and there is none for others";
  pool().release(two, true);
  EXPECT_THAT(granted(), testing::ElementsAre(NodeId{1}));
  EXPECT_FALSE(pool().request(rank(2), two));
  pool().limit(cells, 3);
  EXPECT_THAT(granted(), testing::ElementsAre(NodeId{2}));
  EXPECT_FALSE(pool().request(rank(3), one));
  pool().limit(cells, ResourcePool::kNoLimit);
  EXPECT_THAT(granted(), testing::ElementsAre(NodeId{3}));
}

TEST_F(Pool, AUnitBeyondALimitDoesNotExistForNow) {
  const ResourceId pose = add("pose", 1);
  table_[pose].observed = true;
  const Claims exists{{pose, ResourceOp::Exists}};
  pool().limit(pose, 0);
  EXPECT_FALSE(pool().request(rank(0), exists));
  EXPECT_FALSE(pool().request(rank(1), exists));
  std::vector<ResourcePool::Limited> limited;
  pool().limited(limited);
  ASSERT_EQ(limited.size(), 2U);
  EXPECT_EQ(limited[1].node, NodeId{1});
  EXPECT_EQ(limited[1].resource, pose);
  pool().exempt(NodeId{2});
  EXPECT_TRUE(pool().request(rank(2), exists)) << "it has begun before";
  pool().limit(pose, ResourcePool::kNoLimit);
  EXPECT_THAT(granted(), testing::ElementsAre(NodeId{0}, NodeId{1}));
}

TEST_F(Pool, WhoNeedsMoreThanALimitLeavesKeepsNothingFromOthers) {
  const Claims both{{add("arm", 1)}, {add("pose", 1)}};
  const Claims arm{{add("arm", 1)}};
  pool().limit(*table_.find("pose"), 0);
  EXPECT_FALSE(pool().request(rank(0), both));
  EXPECT_TRUE(pool().request(rank(1), arm));
  pool().limit(*table_.find("pose"), 1);
  EXPECT_FALSE(pool().request(rank(2), arm)) << "now it only waits for the arm";
  pool().release(arm, true);
  EXPECT_THAT(granted(), testing::ElementsAre(NodeId{0}));
}

/// The rule as it is written, looking at everybody each time.
class NaivePool {
 public:
  explicit NaivePool(std::vector<std::uint32_t> free) : free_(free), total_(free), limit_(std::move(free)) {}
  void limit(std::uint32_t resource, std::uint32_t units) { limit_[resource] = units; }
  void request(std::uint32_t node, const Claims& claims) { waiting_[node] = claims; }
  void withdraw(std::uint32_t node) { waiting_.erase(node); }
  void release(const Claims& claims) {
    for (const Claim& claim : claims)
      free_[index(claim.resource)] += claim.count;
  }
  /// Everybody who is granted now.
  std::vector<std::uint32_t> grant() {
    std::vector<std::uint32_t> all;
    for (bool again = true; again;) {
      again = false;
      std::vector<std::int64_t> left(free_.begin(), free_.end());
      for (std::size_t i = 0; i < left.size(); ++i)
        left[i] -= total_[i] - std::min(total_[i], limit_[i]);
      for (auto it = waiting_.begin(); it != waiting_.end() && !again; ++it) {
        bool fits = true;
        const auto exceeds = [&](const Claim& claim) { return claim.count > limit_[index(claim.resource)]; };
        if (std::ranges::any_of(it->second, exceeds)) continue;  // it keeps nothing from others
        for (const Claim& claim : it->second) {
          left[index(claim.resource)] -= claim.count;
          fits = fits && left[index(claim.resource)] >= 0;
        }
        if (!fits) continue;
        for (const Claim& claim : it->second)
          free_[index(claim.resource)] -= claim.count;
        all.push_back(it->first);
        waiting_.erase(it);
        again = true;
        break;
      }
    }
    return all;
  }

 private:
  std::vector<std::uint32_t> free_;
  std::vector<std::uint32_t> total_;
  std::vector<std::uint32_t> limit_;
  std::map<std::uint32_t, Claims> waiting_;
};

RC_GTEST_PROP(ResourcePool, GrantsWhatTheNaiveOneGrants, ()) {
  ResourceTable table;
  std::vector<std::uint32_t> counts;
  for (std::uint32_t i = 0; i < 3; ++i) {
    counts.push_back(*rc::gen::inRange(1U, 5U));
    table[table.intern("r" + std::to_string(i))].count = counts.back();
  }
  ResourcePool pool(table);
  NaivePool naive(counts);
  std::map<std::uint32_t, Claims> claims;
  std::vector<std::uint32_t> holding;
  std::vector<std::uint32_t> waiting;
  const auto steps = *rc::gen::inRange(1, 60);
  for (int i = 0; i < steps; ++i) {
    std::vector<NodeId> granted;
    const int what = *rc::gen::inRange(0, 5);
    if (what == 0 && !holding.empty()) {
      const auto place = *rc::gen::inRange<std::size_t>(0, holding.size());
      pool.release(claims[holding[place]], true);
      naive.release(claims[holding[place]]);
      holding.erase(holding.begin() + static_cast<std::ptrdiff_t>(place));
    } else if (what == 1 && !waiting.empty()) {
      const auto place = *rc::gen::inRange<std::size_t>(0, waiting.size());
      pool.withdraw(rank(waiting[place]), claims[waiting[place]]);
      naive.withdraw(waiting[place]);
      waiting.erase(waiting.begin() + static_cast<std::ptrdiff_t>(place));
    } else if (what == 2) {
      const auto resource = *rc::gen::inRange(0U, 3U);
      const auto units = *rc::gen::inRange(0U, counts[resource] + 1);
      pool.limit(ResourceId{resource}, units);
      naive.limit(resource, units);
    } else {
      const auto node = *rc::gen::inRange(0U, 1000U);
      if (claims.contains(node)) continue;
      for (std::uint32_t r = 0; r < 3; ++r) {
        const auto count = *rc::gen::inRange(0U, counts[r] + 1);
        if (count > 0) claims[node].push_back({ResourceId{r}, ResourceOp::Block, count});
      }
      if (claims[node].empty()) continue;
      naive.request(node, claims[node]);
      if (pool.request(rank(node), claims[node])) granted.emplace_back(NodeId{node});
      waiting.push_back(node);
    }
    std::vector<NodeId> more;
    pool.granted(more);
    granted.insert(granted.end(), more.begin(), more.end());
    std::vector<std::uint32_t> expected = naive.grant();
    std::vector<std::uint32_t> actual;
    for (const NodeId node : granted)
      actual.push_back(index(node));
    std::ranges::sort(expected);
    std::ranges::sort(actual);
    RC_ASSERT(actual == expected);
    for (const std::uint32_t node : actual) {
      holding.push_back(node);
      std::erase(waiting, node);
    }
  }
}

}  // namespace
}  // namespace segue::task_network
