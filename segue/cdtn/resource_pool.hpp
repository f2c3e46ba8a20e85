// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/cdtn/ids.hpp>
#include <segue/cdtn/resource.hpp>

#include <compare>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <vector>

namespace segue::cdtn {

/// Who comes first where several wait: the least rank, then program order.
struct Rank {
  std::uint64_t priority = 0;
  NodeId node{};
  friend auto operator<=>(const Rank&, const Rank&) = default;
};

/// The units of all resources and who holds them. A node gets all that it claims or nothing. Whoever waits
/// keeps its place: a node further back is only granted what would be left if everybody before it had what it
/// waits for, so that it delays nobody ahead. A step costs what is free, not how many wait. Not thread safe.
class ResourcePool {
 public:
  explicit ResourcePool(const ResourceTable& table) : table_(table) { grow(); }

  /// Takes over resources that were added to the table.
  void grow();
  /// Takes over group locks, new ones and new members of known ones. A lock is given back when all its
  /// members have left.
  void take_groups(std::span<const GroupLock> locks);

  /// Grants at once (true), or remembers the node until `granted` names it. Requires that the node neither
  /// waits nor holds anything.
  bool request(Rank rank, std::span<const Claim> claims);
  /// The node does not want it any more. Requires that it waits.
  void withdraw(Rank rank, std::span<const Claim> claims);
  /// Ends what the node holds. `done`: what it would create or delete happens, else it does not (it failed,
  /// or is repeated). What was consumed stays consumed.
  void release(std::span<const Claim> claims, bool done);
  /// A member of the group has ended, or never will begin.
  void leave_group(std::uint32_t group);

  /// Nodes that were granted since the last call, first things first; moves them out.
  void granted(std::vector<NodeId>& nodes);

  [[nodiscard]] std::uint32_t total(ResourceId id) const { return units_[index(id)].total; }
  [[nodiscard]] std::uint32_t free(ResourceId id) const { return units_[index(id)].free; }
  /// How many units more must come free before it is this claim's turn; nothing where it is not for want of
  /// free units that it waits.
  [[nodiscard]] std::optional<std::uint64_t> missing(const Rank& rank, const Claim& claim) const;
  /// Who waits first for units of a resource of which some came free since the last call, and has to go on
  /// waiting; moves them out.
  void still_waiting(std::vector<NodeId>& nodes);
  /// Whether it could be granted if nobody waited; the claim that stands in the way otherwise.
  [[nodiscard]] const Claim* obstacle(std::span<const Claim> claims) const;

 private:
  struct Waiting {
    Rank rank;
    std::shared_ptr<const std::vector<Claim>> claims;  ///< a copy: networks move theirs when they grow
    std::uint64_t need = 0;                            ///< free units of this queue's resource
    friend bool operator<(const Waiting& a, const Waiting& b) { return a.rank < b.rank; }
  };
  struct Units {
    std::uint32_t total = 0;
    std::uint32_t free = 0;
    std::uint32_t leaving = 0;  ///< held by who deletes them when it ends
    std::uint32_t pinned = 0;   ///< units that an `exists` relies on, the most of all
    std::uint32_t pins = 0;
    std::uint64_t wanted = 0;  ///< by all who wait
    std::set<Waiting> queue;
  };
  struct Group {
    GroupLock lock;
    std::uint32_t left = 0;    ///< members that have
    std::uint32_t inside = 0;  ///< units that no member uses
    bool held = false;
  };

  [[nodiscard]] std::uint32_t need(const Claim& claim) const;
  [[nodiscard]] std::uint64_t need(std::span<const Claim> claims, ResourceId id) const;
  [[nodiscard]] bool fits_but_for_units(const Claim& claim) const;
  [[nodiscard]] bool can_wait(const Claim& claim) const;
  [[nodiscard]] bool turn(const Rank& rank, std::uint64_t own, ResourceId id) const;
  [[nodiscard]] bool grantable(const Rank& rank, std::span<const Claim> claims) const;
  void take(const Claim& claim);
  void give_back(const Claim& claim, bool done);
  void enqueue(const Rank& rank, std::span<const Claim> claims);
  void dequeue(const Rank& rank, std::span<const Claim> claims);
  void look(ResourceId id);

  const ResourceTable& table_;
  std::vector<Units> units_;
  std::vector<Group> groups_;
  std::vector<NodeId> granted_;
  std::vector<NodeId> still_waiting_;
};

}  // namespace segue::cdtn
