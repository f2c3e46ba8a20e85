// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/task_network/resource_pool.hpp>
#include <segue/task_network/run_result.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace segue::task_network {

/// How many units of observed resources can be had from now on.
struct UnitLimits {
  std::vector<std::pair<ResourceId, std::uint32_t>> units;  ///< as of ResourcePool::limit()
  std::string lost;  ///< why nobody will say more; empty: somebody may. Then nodes that wait abort.
};

/// Limits on their way to an engine, and the nodes that wait because of them. All functions belong to the
/// engine's thread, except ask().
class UnitWaits {
 public:
  /// Heeded by the next take(). On any thread.
  void ask(UnitLimits limits) {
    const Lock lock(mutex_);
    asked_ = std::move(limits);
  }
  /// Has the pool heed what was asked last.
  void take(ResourcePool& pool) {
    Lock lock(mutex_);
    auto limits = std::exchange(asked_, std::nullopt);
    lock.unlock();
    if (!limits) return;
    for (const auto& [resource, units] : limits->units)
      pool.limit(resource, units);
    lost_ = std::move(limits->lost);
    are_known_ = true;
  }
  /// Looks who waits now.
  void look(const ResourcePool& pool) { pool.limited(now_); }
  [[nodiscard]] const std::vector<ResourcePool::Limited>& now() const { return now_; }
  /// Whether any limits were taken.
  [[nodiscard]] bool are_known() const { return are_known_; }
  [[nodiscard]] const std::string& lost() const { return lost_; }
  /// Notes that the node waits; true the first time.
  bool began(const ResourcePool::Limited& one, TimePoint when) {
    return began_.try_emplace(one.node, UnitWait{one.node, one.resource, when, {}}).second;
  }
  /// The node waits no longer.
  void ended(NodeId node, TimePoint when) {
    const auto found = began_.empty() ? began_.end() : began_.find(node);
    if (found == began_.end()) return;
    found->second.until = when;
    all_.push_back(found->second);
    began_.erase(found);
  }
  /// Moves out all waits that have ended.
  std::vector<UnitWait> all() { return std::move(all_); }

 private:
  Mutex mutex_;  ///< protects the next one
  std::optional<UnitLimits> asked_ SEGUE_GUARDED_BY(mutex_);
  std::vector<ResourcePool::Limited> now_;
  std::map<NodeId, UnitWait> began_;  ///< that have not ended
  std::vector<UnitWait> all_;
  std::string lost_;
  bool are_known_ = false;
};

}  // namespace segue::task_network
