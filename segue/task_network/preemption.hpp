// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/task_network/node_ids.hpp>
#include <segue/task_network/resource_pool.hpp>

#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <utility>

/// The engine's records of runs that it preempts. Internal to ConcurrentEngine.
namespace segue::task_network {

/// The speculative runs that hold units of a resource, and how many they can give back.
struct SpeculativeHolders {
  std::set<Rank> ranks;
  std::uint64_t units = 0;
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
