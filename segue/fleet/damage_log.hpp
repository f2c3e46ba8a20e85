// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/mutex.hpp>
#include <segue/fleet/merged_view.hpp>

#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace segue::fleet::detail {

/// Remembers which connections were ended because their shared memory was overwritten, until they are made
/// again, and finds out which process does so again and again. Thread safe; calls nobody.
class DamageLog {
 public:
  /// A process that is at fault, and why.
  struct Culprit {
    Suspect process;
    std::string why;
  };

  /// Takes over what was seen: what is damaged is added, what carries samples again is forgotten. Gives the
  /// connections that are new in it, and the processes that are found to be at fault now: those which can
  /// have overwritten kMost connections within kPeriod, unless another process can have overwritten all of
  /// these.
  struct Found {
    std::vector<DamagedConnection> damaged;
    std::vector<Culprit> culprits;
  };
  Found note(const MergedView& seen, TimePoint now);
  /// Forgets all damage: a transition is complete, so all connections that it wanted exist.
  void clear();
  /// The connections, with `error`.
  [[nodiscard]] std::vector<task_host::ConnectionReport> reports() const;

  static constexpr std::size_t kMost = 3;
  static constexpr Duration kPeriod = std::chrono::minutes(10);

 private:
  struct Event {
    TimePoint time;
    std::vector<Suspect> suspects;
  };
  using Key = std::pair<model::PortRef, model::PortRef>;
  [[nodiscard]] std::vector<Culprit> find_culprits(const std::vector<Suspect>& suspects)
      SEGUE_REQUIRES(mutex_);
  [[nodiscard]] bool is_at_fault(const Suspect& suspect) const SEGUE_REQUIRES(mutex_);

  mutable Mutex mutex_;  ///< protects all below
  std::map<Key, DamagedConnection> damaged_ SEGUE_GUARDED_BY(mutex_);
  std::deque<Event> events_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::fleet::detail
