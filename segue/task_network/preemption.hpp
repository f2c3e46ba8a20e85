// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/task_network/node_ids.hpp>
#include <segue/task_network/resource_pool.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

/// The engine's records of runs that it preempts. Internal to ConcurrentEngine.
namespace segue::task_network {

/// The speculative runs that hold units of a resource, and how many they can give back.
struct SpeculativeHolders {
  std::set<Rank> ranks;
  std::uint64_t units = 0;
};

/// The units that runs hold which can be preempted, and those that preempted runs still hold, by resource.
class PreemptibleUnits {
 public:
  using Claims = std::span<const Claim>;
  void grow(std::size_t resources) {
    holders_.resize(resources);
    coming_.resize(resources);
  }
  /// A speculative run holds the units of its claims, until it ends or is cancelled.
  void hold(const Rank& rank, Claims claims) {
    for (const Claim& claim : claims) {
      SpeculativeHolders& holders = holders_[index(claim.resource)];
      if (holders.ranks.insert(rank).second) holders.units += blocked(claims, claim.resource);
    }
  }
  void give_back(const Rank& rank, Claims claims) {
    for (const Claim& claim : claims) {
      SpeculativeHolders& holders = holders_[index(claim.resource)];
      if (holders.ranks.erase(rank) > 0) holders.units -= blocked(claims, claim.resource);
    }
  }
  /// A cancelled run still holds its units, or has ended.
  void cancelled(Claims claims, bool holds) {
    for (const Claim& claim : claims) {
      if (claim.op != ResourceOp::Block || claim.group != kNone) continue;
      std::uint64_t& units = coming_[index(claim.resource)];
      units = holds ? units + claim.count : units - claim.count;
    }
  }
  /// Whether a speculative run of higher rank value holds units of a resource that is claimed.
  [[nodiscard]] bool held_behind(const Rank& rank, Claims claims) const {
    return std::ranges::any_of(claims, [&](const Claim& claim) {
      const auto& ranks = holders_[index(claim.resource)].ranks;
      return !ranks.empty() && rank < *ranks.rbegin();
    });
  }
  [[nodiscard]] const SpeculativeHolders& holders(ResourceId resource) const {
    return holders_[index(resource)];
  }
  /// Units that cancelled runs will give back.
  [[nodiscard]] std::uint64_t coming(ResourceId resource) const { return coming_[index(resource)]; }
  /// The units of the resource that a run with these claims gives back when it ends.
  [[nodiscard]] static std::uint64_t blocked(Claims claims, ResourceId resource) {
    std::uint64_t units = 0;
    for (const Claim& claim : claims) {
      if (claim.resource == resource && claim.op == ResourceOp::Block) units += claim.count;
    }
    return units;
  }

 private:
  std::vector<SpeculativeHolders> holders_;
  std::vector<std::uint64_t> coming_;
};

/// The times by which preempted runs must have ended, in real time.
class Patience {
 public:
  /// Sets the time for all runs, after a failure or a stop.
  void with_all(TimePoint until) { all_ = until; }
  /// Sets the time for the run of a node that has lost a race. Calls follow each other in time.
  void with(NodeId node, TimePoint until) { lost_.emplace_back(until, node); }
  /// The next time at which somebody is given up.
  [[nodiscard]] TimePoint deadline() const {
    return lost_.empty() ? all_ : std::min(all_, lost_.front().first);
  }
  /// Takes out a node that has lost a race and whose time is up.
  std::optional<NodeId> next_overdue(TimePoint now) {
    if (lost_.empty() || now < lost_.front().first) return std::nullopt;
    const NodeId node = lost_.front().second;
    lost_.pop_front();
    return node;
  }

 private:
  TimePoint all_ = TimePoint::max();
  std::deque<std::pair<TimePoint, NodeId>> lost_;
};

}  // namespace segue::task_network
