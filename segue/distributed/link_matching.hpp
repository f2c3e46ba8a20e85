// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/distributed/action_router.hpp>
#include <segue/distributed/sites.hpp>

#include <map>
#include <optional>

namespace segue::distributed::detail {

/// Waits until the senders and receivers that a transition creates have found each other, so that no sample
/// is sent before somebody receives it. Thread safe.
class LinkMatching {
 public:
  LinkMatching(const Sites& sites, const ActionRouter& router) : sites_(sites), router_(router) {}

  /// Notes the begin of a transition from `before`, whose links carry samples already.
  void begin_transition(const model::Network& before);
  /// Lets all hosts get ready for `target`, and blocks until all links of it that are new have found each
  /// other, for ten seconds at most. One message for each host.
  void get_ready(const model::Network& target);
  /// The result of the last get_ready(): an error for the links that have not found their counterparts.
  [[nodiscard]] Result<void> outcome() const;

 private:
  /// Senders and receivers, and how many of the others each has to find.
  using Links = std::map<model::TaskId, int>;
  static Links links_of(const model::Network& network);
  [[nodiscard]] Links new_links(const model::Network& target) const;

  const Sites& sites_;
  const ActionRouter& router_;
  mutable Mutex mutex_;  ///< protects both below
  Links before_ SEGUE_GUARDED_BY(mutex_);
  std::optional<Error> unmatched_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::distributed::detail
