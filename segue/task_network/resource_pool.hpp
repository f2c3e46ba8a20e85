// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_network/node_ids.hpp>
#include <segue/task_network/resource.hpp>

#include <algorithm>
#include <compare>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <vector>

namespace segue::task_network {

/// The order of waiting nodes: those first that are likelier to count, then the least priority value, then
/// program order.
struct Rank {
  std::uint16_t unlikely = 0;  ///< 0: it counts for certain, as far as conditions decide that
  std::uint64_t priority = 0;
  NodeId node{};
  friend auto operator<=>(const Rank&, const Rank&) = default;
};

/// Allocates the units of all resources. A node gets everything that it claims or nothing. Waiting nodes are
/// not overtaken: a later node is only granted units that would be left if all nodes before it had what they
/// wait for; but a node that needs more units than a limit leaves keeps none from others, whatever it needs
/// besides. The cost of a step grows with the free units, not with the number of waiting nodes, but for
/// resources with limits. Not thread safe.
class ResourcePool {
 public:
  explicit ResourcePool(const ResourceTable& table) : table_(table) { grow(); }

  /// Adds the resources that were added to the table since the last call.
  void grow();
  /// Adds group locks, and new members of known ones. A lock is released when all its members have left.
  void take_groups(std::span<const GroupLock> locks);

  /// Grants at once (true), or remembers the node until `granted` names it. Requires that the node neither
  /// waits nor holds anything.
  bool request(Rank rank, std::span<const Claim> claims);
  /// The node does not want it any more. Requires that it waits.
  void withdraw(Rank rank, std::span<const Claim> claims);
  /// Releases the units that the node holds. `done`: units that it declares to create or delete are created
  /// or deleted; otherwise (it failed or is repeated) not. Consumed units stay consumed in either case.
  void release(std::span<const Claim> claims, bool done);
  /// Adds that many units, or removes them where negative; nobody holds or waits for them.
  void change(ResourceId id, std::int64_t units);
  /// From now on that many units can be had at most, with those that are held; `kNoLimit`: all. Who holds
  /// more keeps them. All units count as existing nevertheless (total(), shortage()). The resource must be
  /// one that is observed.
  void limit(ResourceId id, std::uint32_t units);
  static constexpr std::uint32_t kNoLimit = kNone;
  /// Limits are none for this node, since it has begun in an earlier run.
  void exempt(NodeId node) { exempt_.insert(index(node)); }
  /// A node that waits for units which could be had if there were no limit.
  struct Limited {
    NodeId node{};
    ResourceId resource{};
    std::uint32_t count = 0;  ///< that it claims
    std::uint32_t limit = 0;
  };
  /// Replaces `nodes` by all that there are, by resource and rank.
  void limited(std::vector<Limited>& nodes) const;
  /// A member of the group has ended, or will never begin.
  void leave_group(std::uint32_t group);

  /// Moves out the nodes that were granted since the last call, in that order.
  void granted(std::vector<NodeId>& nodes);
  /// Whether `granted` will name the node.
  [[nodiscard]] bool has_granted(NodeId node) const {
    return std::ranges::find(granted_, node) != granted_.end();
  }

  [[nodiscard]] std::uint32_t total(ResourceId id) const { return units_[index(id)].total; }
  [[nodiscard]] std::uint32_t free(ResourceId id) const { return units_[index(id)].free; }
  /// How many more units must become free before this claim is granted; nullopt if they are more than `most`,
  /// or if it waits for another reason. Looks at no more waiting nodes than that takes.
  [[nodiscard]] std::optional<std::uint64_t> missing(const Rank& rank, const Claim& claim,
                                                     std::uint64_t most) const;
  /// Moves out, for each resource of which units became free since the last call, the first node that still
  /// has to wait.
  void still_waiting(std::vector<NodeId>& nodes);
  /// How many waiting nodes it has looked at: what it costs, for tests.
  [[nodiscard]] std::uint64_t looked_at() const { return looked_at_; }
  struct Shortage {
    const Claim* claim = nullptr;
    std::uint64_t there = 0;  ///< units, without those that groups hold
  };
  /// The first claim that cannot be met even if every node gave back what it holds; nothing if there is none.
  [[nodiscard]] std::optional<Shortage> shortage(std::span<const Claim> claims) const;
  /// The claim that could not be granted even if no other node waited; null if there is none.
  [[nodiscard]] const Claim* obstacle(std::span<const Claim> claims) const;

 private:
  struct Waiting {
    Rank rank;
    std::shared_ptr<const std::vector<Claim>> claims;  ///< a copy, because a growing network moves its own
    std::uint64_t need = 0;                            ///< free units of this queue's resource
    friend bool operator<(const Waiting& a, const Waiting& b) { return a.rank < b.rank; }
  };
  struct Units {
    std::uint32_t total = 0;
    std::uint32_t free = 0;
    std::uint32_t leaving = 0;  ///< held by nodes that delete them when they end
    std::uint32_t pinned = 0;   ///< the largest number of units that a running `exists` relies on
    std::uint32_t pins = 0;
    std::uint64_t wanted = 0;  ///< by all waiting nodes
    std::uint32_t limit = kNoLimit;
    std::set<Waiting> queue;
  };
  struct Group {
    GroupLock lock;
    std::uint32_t left = 0;    ///< members that have left
    std::uint32_t inside = 0;  ///< units that no member uses now
    bool held = false;
  };

  [[nodiscard]] std::uint32_t need(const Claim& claim) const;
  [[nodiscard]] std::uint64_t need(std::span<const Claim> claims, ResourceId id) const;
  [[nodiscard]] std::uint64_t withheld(NodeId node, const Claim& claim) const;
  [[nodiscard]] const Claim* limited_claim(NodeId node, std::span<const Claim> claims) const;
  [[nodiscard]] bool exceeds_limits(NodeId node, std::span<const Claim> claims) const;
  [[nodiscard]] bool fits_but_for_units(const Claim& claim, NodeId node) const;
  [[nodiscard]] bool can_wait(const Claim& claim) const;
  [[nodiscard]] bool turn(const Rank& rank, std::uint64_t own, const Claim& claim) const;
  [[nodiscard]] bool grantable(const Rank& rank, std::span<const Claim> claims) const;
  void take(const Claim& claim);
  void give_back(const Claim& claim, bool done);
  void enqueue(const Rank& rank, std::span<const Claim> claims);
  void dequeue(const Rank& rank, std::span<const Claim> claims);
  void grant_waiting(ResourceId id, bool all = false);

  const ResourceTable& table_;
  std::vector<Units> units_;
  std::vector<Group> groups_;
  std::vector<NodeId> granted_;
  std::vector<NodeId> still_waiting_;
  std::vector<ResourceId> limited_;  ///< that have had a limit
  std::set<std::uint32_t> exempt_;   ///< nodes
  mutable std::uint64_t looked_at_ = 0;
};

}  // namespace segue::task_network
