// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/distributed/action_router.hpp>
#include <segue/distributed/sites.hpp>

#include <cstdint>
#include <functional>
#include <set>
#include <string>

namespace segue::distributed::detail {

/// Commits a transition on several computers: all of them, or none, unless one falls silent between its vote
/// and its answer. Thread safe.
class DistributedCommit {
 public:
  /// `clock` measures how long promises take; outlives this, as all do.
  DistributedCommit(Sites& sites, ActionRouter& router, Duration promise, const Clock& clock)
      : sites_(sites), router_(router), promise_(promise), clock_(clock) {}

  /// Arms the computers on which connections begin or end with the transition.
  Result<void> arm(const model::Transition& transition, TimePoint deadline);
  /// Two rounds: promises, then commits. An error where a computer does not promise (nothing has changed
  /// then), or where it refuses or does not answer afterwards.
  Result<void> commit();
  void give_up();

 private:
  using Ask = std::function<Result<void>(const Site& site, HostedRobot& robot)>;
  /// Handles an error of a call over the connection of that number.
  using Failed = std::function<void(const Site& site, const Error& error, std::uint64_t number)>;
  /// Asks `sites` at the same time; the first error, which names its host.
  Result<void> ask_all(const std::set<const Site*>& sites, const std::string& what, const Ask& ask,
                       const Failed& failed) const;
  /// The first round. An error too where a promise comes so late that others may have run out.
  Result<void> promise(const std::set<const Site*>& sites, std::uint64_t number) const;

  Sites& sites_;
  ActionRouter& router_;
  const Duration promise_;
  const Clock& clock_;
  Mutex mutex_;                                           ///< protects both below
  std::uint64_t number_ SEGUE_GUARDED_BY(mutex_) = 0;     ///< of the latest transition
  std::set<const Site*> armed_ SEGUE_GUARDED_BY(mutex_);  ///< that take part in it
};

}  // namespace segue::distributed::detail
