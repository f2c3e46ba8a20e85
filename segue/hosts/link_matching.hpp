// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/hosts/action_router.hpp>
#include <segue/hosts/sites.hpp>

#include <map>
#include <mutex>
#include <optional>

namespace segue::hosts::detail {

/// Waits until the senders and receivers that a transition creates have found each other, so that no sample
/// is sent before somebody receives it. Thread safe.
class LinkMatching {
 public:
  /// `patience`: how long a host may take to answer, besides the wait itself.
  LinkMatching(const Sites& sites, const ActionRouter& router, Duration patience)
      : sites_(sites), router_(router), patience_(patience) {}

  /// A transition from `before` begins. What is linked there carries samples already.
  void begin_transition(const model::Network& before);
  /// Blocks until all links of `target` that are new have found each other, for ten seconds at most.
  void wait_for(const model::Network& target);
  /// Which link of the last wait_for() has not found its counterparts.
  [[nodiscard]] Result<void> outcome() const;

 private:
  /// Senders and receivers, and how many of the others each has to find.
  using Links = std::map<model::TaskId, int>;
  static Links links_of(const model::Network& network);
  [[nodiscard]] Links new_links(const model::Network& target) const;
  Result<void> wait_for(const model::TaskId& task, int count, TimePoint deadline) const;

  const Sites& sites_;
  const ActionRouter& router_;
  const Duration patience_;
  mutable std::mutex mutex_;  ///< protects both below
  Links before_;
  std::optional<Error> unmatched_;
};

}  // namespace segue::hosts::detail
