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

bool ResourcePool::fits_but_for_units(const Claim& claim) const {
  const Units& units = units_[index(claim.resource)];
  if (claim.group != kNone)
    return claim.op != ResourceOp::Block || groups_[claim.group].inside >= claim.count;
  switch (claim.op) {
    case ResourceOp::Exists:
      return units.total >= claim.count + units.leaving;
    case ResourceOp::Consume:
    case ResourceOp::Delete:
      return units.total >= claim.count + units.pinned;
    default:
      return true;
  }
}

/// Whether enough units are free for the claim and for all nodes that wait before it.
bool ResourcePool::turn(const Rank& rank, std::uint64_t own, ResourceId id) const {
  const Units& units = units_[index(id)];
  if (own > units.free) return false;
  if (own == 0 || units.wanted + own <= units.free) return true;
  std::uint64_t ahead = own;
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
    return fits_but_for_units(claim) && turn(rank, need(claims, claim.resource), claim.resource);
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
    return !fits_but_for_units(claim) || need(claims, claim.resource) > free(claim.resource);
  });
  return found == claims.end() ? nullptr : &*found;
}

std::optional<std::uint64_t> ResourcePool::missing(const Rank& rank, const Claim& claim,
                                                   std::uint64_t most) const {
  if (!fits_but_for_units(claim)) return std::nullopt;
  const Units& units = units_[index(claim.resource)];
  if (!can_wait(claim)) return 0;
  const auto own = units.queue.find({rank, nullptr, 0});
  if (own == units.queue.end()) return std::nullopt;  // it has just been granted
  std::uint64_t wanted = own->need;
  if (wanted == 0) return 0;
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
  return claim.op != ResourceOp::Release && (claim.op != ResourceOp::Exists || table_[claim.resource].varies);
}

void ResourcePool::enqueue(const Rank& rank, std::span<const Claim> claims) {
  const auto own = std::make_shared<const std::vector<Claim>>(claims.begin(), claims.end());
  for (const Claim& claim : claims) {
    if (!can_wait(claim)) continue;
    Units& units = units_[index(claim.resource)];
    const std::uint64_t needed = need(claims, claim.resource);
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
/// seen so far want more than is free, since later ones may not overtake them.
void ResourcePool::grant_waiting(ResourceId id) {
  Units& units = units_[index(id)];
  std::uint64_t ahead = 0;
  for (auto next = units.queue.begin(); next != units.queue.end() && ahead <= units.free;) {
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
  if (!units.queue.empty()) still_waiting_.push_back(units.queue.begin()->rank.node);
}

void ResourcePool::granted(std::vector<NodeId>& nodes) {
  nodes.clear();
  nodes.swap(granted_);
}

}  // namespace segue::task_network
