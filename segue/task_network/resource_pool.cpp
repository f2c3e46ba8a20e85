// SPDX-License-Identifier: Apache-2.0
#include "resource_pool.hpp"

#include <segue/task_network/engine_fault.hpp>

#include <algorithm>

namespace segue::task_network {

void ResourcePool::grow() {
  for (std::size_t i = units_.size(); i < table_.size(); ++i) {
    Units& units = units_.emplace_back();
    units.total = units.free = table_[ResourceId{static_cast<std::uint32_t>(i)}].count;
  }
}

void ResourcePool::take_groups(std::span<const GroupLock> locks) {
  for (std::size_t i = 0; i < locks.size(); ++i) {
    if (i == groups_.size())
      groups_.push_back({locks[i], 0, locks[i].count, false});
    else
      groups_[i].lock.members = locks[i].members;
  }
}

std::uint32_t ResourcePool::need(const Claim& claim) const {
  if (claim.op == ResourceOp::Create) return 0;
  if (claim.group != kNone) return groups_[claim.group].held ? 0 : groups_[claim.group].lock.count;
  return claim.op == ResourceOp::Exists || claim.op == ResourceOp::Release ? 0 : claim.count;
}

/// The units of one resource that all claims need together; the units of a group count once.
std::uint64_t ResourcePool::need(std::span<const Claim> claims, ResourceId id) const {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < claims.size(); ++i) {
    if (claims[i].resource != id) continue;
    const auto before = claims.first(i);
    const bool known =
        claims[i].group != kNone && std::ranges::find(before, claims[i].group, &Claim::group) != before.end();
    if (!known) sum += need(claims[i]);
  }
  return sum;
}

/// Units that exist, and that the limit keeps from the node. A group that takes its units again has had them
/// all along, as far as its members know.
std::uint64_t ResourcePool::withheld(NodeId node, const Claim& claim) const {
  const Units& units = units_[index(claim.resource)];
  if (units.limit >= units.total || exempt_.contains(index(node))) return 0;
  const bool again = claim.group != kNone && groups_[claim.group].left > 0;
  return again ? 0 : units.total - units.limit;
}

/// Whether the node could not have what it claims even if no other node held or wanted anything.
bool ResourcePool::exceeds_limits(NodeId node, std::span<const Claim> claims) const {
  return !limited_.empty() && std::ranges::any_of(claims, [&](const Claim& claim) {
    const bool exists = claim.group == kNone && claim.op == ResourceOp::Exists;
    const std::uint64_t needed = exists ? claim.count : need(claims, claim.resource);
    return withheld(node, claim) > 0 && needed > units_[index(claim.resource)].limit;
  });
}

bool ResourcePool::fits_but_for_units(const Claim& claim, NodeId node) const {
  const Units& units = units_[index(claim.resource)];
  if (claim.group != kNone)
    return claim.op != ResourceOp::Block || groups_[claim.group].inside >= claim.count;
  switch (claim.op) {
    case ResourceOp::Exists:
      return units.total >= claim.count + units.leaving + withheld(node, claim);
    case ResourceOp::Consume:
    case ResourceOp::Delete:
      return units.total >= claim.count + units.pinned;
    default:
      return true;
  }
}

/// Whether enough units are free for the claim and for all nodes that wait before it.
bool ResourcePool::turn(const Rank& rank, std::uint64_t own, const Claim& claim) const {
  if (own == 0) return true;
  const Units& units = units_[index(claim.resource)];
  std::uint64_t ahead = own + withheld(rank.node, claim);
  if (ahead > units.free) return false;
  if (units.wanted + ahead <= units.free) return true;
  for (const Waiting& waiting : units.queue) {
    ++looked_at_;
    if (!(waiting.rank < rank)) break;
    ahead += waiting.need;
    if (ahead > units.free) return false;
  }
  return true;
}

bool ResourcePool::grantable(const Rank& rank, std::span<const Claim> claims) const {
  return std::ranges::all_of(claims, [&](const Claim& claim) {
    return fits_but_for_units(claim, rank.node) && turn(rank, need(claims, claim.resource), claim);
  });
}

std::optional<ResourcePool::Shortage> ResourcePool::shortage(std::span<const Claim> claims) const {
  for (const Claim& claim : claims) {
    const bool exists = claim.group == kNone && claim.op == ResourceOp::Exists;
    std::uint64_t there = total(claim.resource);
    for (const Group& group : groups_) {
      if (!exists && group.held && group.lock.resource == claim.resource) there -= group.lock.count;
    }
    if ((exists ? claim.count : need(claims, claim.resource)) > there) return Shortage{&claim, there};
  }
  return std::nullopt;
}

const Claim* ResourcePool::obstacle(std::span<const Claim> claims) const {
  const auto found = std::ranges::find_if(claims, [&](const Claim& claim) {
    return !fits_but_for_units(claim, NodeId{kNone}) || need(claims, claim.resource) > free(claim.resource);
  });
  return found == claims.end() ? nullptr : &*found;
}

std::optional<std::uint64_t> ResourcePool::missing(const Rank& rank, const Claim& claim,
                                                   std::uint64_t most) const {
  if (!fits_but_for_units(claim, rank.node)) return std::nullopt;
  const Units& units = units_[index(claim.resource)];
  if (!can_wait(claim)) return 0;
  const auto own = units.queue.find({rank, nullptr, 0});
  if (own == units.queue.end()) return std::nullopt;  // it has just been granted
  if (own->need == 0) return 0;
  std::uint64_t wanted = own->need + withheld(rank.node, claim);
  for (const Waiting& waiting : units.queue) {
    ++looked_at_;
    if (!(waiting.rank < rank)) break;
    wanted += waiting.need;
    if (wanted > units.free + most) return std::nullopt;
  }
  if (wanted > units.free + most) return std::nullopt;
  return wanted <= units.free ? 0 : wanted - units.free;
}

void ResourcePool::still_waiting(std::vector<NodeId>& nodes) {
  nodes.clear();
  nodes.swap(still_waiting_);
}

void ResourcePool::take(const Claim& claim) {
  Units& units = units_[index(claim.resource)];
  if (!planted(EngineFault::GrantsTwice)) units.free -= need(claim);
  if (claim.group != kNone) {
    groups_[claim.group].held = true;
    if (claim.op == ResourceOp::Block) groups_[claim.group].inside -= claim.count;
    return;
  }
  if (claim.op == ResourceOp::Consume) units.total -= claim.count;
  if (claim.op == ResourceOp::Delete) units.leaving += claim.count;
  if (claim.op == ResourceOp::Exists) {
    ++units.pins;
    units.pinned = std::max(units.pinned, claim.count);
  }
}

void ResourcePool::give_back(const Claim& claim, bool done) {
  Units& units = units_[index(claim.resource)];
  if (claim.group != kNone) {
    if (claim.op == ResourceOp::Block) groups_[claim.group].inside += claim.count;
    return;
  }
  switch (claim.op) {
    case ResourceOp::Create:
      if (done) {
        units.total += claim.count;
        units.free += claim.count;
      }
      break;
    case ResourceOp::Delete:
      units.leaving -= claim.count;
      if (done)
        units.total -= claim.count;
      else
        units.free += claim.count;
      break;
    case ResourceOp::Block:
      if (!planted(EngineFault::GrantsTwice)) units.free += claim.count;
      break;
    case ResourceOp::Exists:
      if (--units.pins == 0) units.pinned = 0;
      break;
    case ResourceOp::Consume:
      if (planted(EngineFault::ReturnsConsumed)) units.total += claim.count;
      break;
    case ResourceOp::Release:
      break;
  }
}

/// Whether a claim can block its node; only then the node waits in the queue of that resource.
bool ResourcePool::can_wait(const Claim& claim) const {
  if (claim.op == ResourceOp::Create) return false;
  if (claim.group != kNone) return true;
  const ResourceRecord& resource = table_[claim.resource];
  return claim.op != ResourceOp::Release &&
         (claim.op != ResourceOp::Exists || resource.varies || resource.observed);
}

void ResourcePool::enqueue(const Rank& rank, std::span<const Claim> claims) {
  const auto own = std::make_shared<const std::vector<Claim>>(claims.begin(), claims.end());
  const bool keeps_nothing = exceeds_limits(rank.node, claims);
  for (const Claim& claim : claims) {
    if (!can_wait(claim)) continue;
    Units& units = units_[index(claim.resource)];
    const std::uint64_t needed = keeps_nothing ? 0 : need(claims, claim.resource);
    if (units.queue.insert({rank, own, needed}).second) units.wanted += needed;
  }
}

void ResourcePool::dequeue(const Rank& rank, std::span<const Claim> claims) {
  for (const Claim& claim : claims) {
    Units& units = units_[index(claim.resource)];
    const auto found = units.queue.find({rank, nullptr, 0});
    if (found == units.queue.end()) continue;
    units.wanted -= found->need;
    units.queue.erase(found);
  }
}

bool ResourcePool::request(Rank rank, std::span<const Claim> claims) {
  if (!grantable(rank, claims)) {
    enqueue(rank, claims);
    return false;
  }
  for (const Claim& claim : claims)
    take(claim);
  return true;
}

void ResourcePool::withdraw(Rank rank, std::span<const Claim> claims) {
  dequeue(rank, claims);
  for (const Claim& claim : claims)
    grant_waiting(claim.resource);
}

void ResourcePool::release(std::span<const Claim> claims, bool done) {
  for (const Claim& claim : claims)
    give_back(claim, done);
  for (const Claim& claim : claims)
    grant_waiting(claim.resource);
}

void ResourcePool::change(ResourceId id, std::int64_t units) {
  Units& own = units_[index(id)];
  own.total = static_cast<std::uint32_t>(own.total + units);
  own.free = static_cast<std::uint32_t>(own.free + units);
}

void ResourcePool::limit(ResourceId id, std::uint32_t units) {
  Units& own = units_[index(id)];
  if (own.limit == units) return;
  own.limit = units;
  if (std::ranges::find(limited_, id) == limited_.end()) limited_.push_back(id);
  std::set<ResourceId> concerned = {id};
  const std::vector<Waiting> waiting(own.queue.begin(), own.queue.end());
  for (const Waiting& one : waiting) {
    dequeue(one.rank, *one.claims);
    enqueue(one.rank, *one.claims);  // what it keeps from others may be another
    for (const Claim& claim : *one.claims)
      concerned.insert(claim.resource);
  }
  for (const ResourceId resource : concerned)
    grant_waiting(resource, resource == id);
}

/// The first of these claims that a limit alone keeps from the node; null: none.
const Claim* ResourcePool::limited_claim(NodeId node, std::span<const Claim> claims) const {
  const auto found = std::ranges::find_if(claims, [&](const Claim& claim) {
    const Units& units = units_[index(claim.resource)];
    const std::uint64_t missing = withheld(node, claim);
    if (claim.group == kNone && claim.op == ResourceOp::Exists) {
      const std::uint64_t needed = std::uint64_t{claim.count} + units.leaving;
      return needed <= units.total && needed + missing > units.total;
    }
    const std::uint64_t own = need(claims, claim.resource);
    return own > 0 && own <= units.free && own + missing > units.free;
  });
  return found == claims.end() ? nullptr : &*found;
}

void ResourcePool::limited(std::vector<Limited>& nodes) const {
  nodes.clear();
  for (const ResourceId id : limited_) {
    const Units& units = units_[index(id)];
    if (units.limit >= units.total) continue;
    for (const Waiting& waiting : units.queue) {
      const Claim* claim = limited_claim(waiting.rank.node, *waiting.claims);
      if (claim != nullptr && claim->resource == id)
        nodes.push_back({waiting.rank.node, id, claim->count, units.limit});
    }
  }
}

void ResourcePool::leave_group(std::uint32_t group) {
  Group& left = groups_[group];
  ++left.left;
  const bool early = planted(EngineFault::LeavesGroupEarly);
  if (!left.held || (left.left < left.lock.members && !early)) return;
  left.held = false;
  units_[index(left.lock.resource)].free += left.lock.count;
  grant_waiting(left.lock.resource);
}

/// Grants the nodes that can start now that units of this resource are free. The walk ends once the nodes
/// seen so far want more than is free, since later ones may not overtake them; but for `all`, and below a
/// limit, since some nodes only need units to exist, and others need not heed it.
void ResourcePool::grant_waiting(ResourceId id, bool all) {
  Units& units = units_[index(id)];
  all = all || units.limit < units.total;
  std::uint64_t ahead = 0;
  for (auto next = units.queue.begin(); next != units.queue.end() && (all || ahead <= units.free);) {
    ++looked_at_;
    const Waiting waiting = *next++;
    if (grantable(waiting.rank, *waiting.claims)) {
      dequeue(waiting.rank, *waiting.claims);
      for (const Claim& claim : *waiting.claims)
        take(claim);
      granted_.push_back(waiting.rank.node);
    } else {
      ahead += waiting.need;
    }
  }
  const auto first = std::ranges::find_if(units.queue, [](const Waiting& one) { return one.need > 0; });
  if (first != units.queue.end()) still_waiting_.push_back(first->rank.node);
}

void ResourcePool::granted(std::vector<NodeId>& nodes) {
  nodes.clear();
  nodes.swap(granted_);
}

}  // namespace segue::task_network
