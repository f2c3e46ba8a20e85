// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/distributed/sites.hpp>

#include <set>

namespace segue::distributed::detail {

/// The claim with which a runtime requests its robot from hosts. Where it takes the robot over, its term is
/// above those of all runtimes that have had it on any of the hosts; so of several that do this at the same
/// moment, the same one wins on all hosts (Lease), instead of each losing the robot on some of them.
class RobotClaim {
 public:
  /// `request`: with take_over where its user has asked for that. `sites` must outlive this.
  RobotClaim(const Sites& sites, RobotRequest request) : sites_(sites), request_(std::move(request)) {}

  /// Asks all hosts for their highest terms, if the runtime takes the robot over; asks them all at the same
  /// time. Blocks until `deadline` at most. Called before everything below, once.
  void choose_term(TimePoint deadline);
  /// The request with which a host is asked first. A host that has not told its terms is not taken over,
  /// since others may have a higher one there.
  [[nodiscard]] RobotRequest first(const Site& site) const;
  /// The request with which a host is asked again: it takes the robot from another runtime only if the user
  /// has asked for that.
  [[nodiscard]] RobotRequest later() const;

 private:
  const Sites& sites_;
  RobotRequest request_;
  std::set<const Site*> told_;
};

}  // namespace segue::distributed::detail
