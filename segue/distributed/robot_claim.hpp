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

  /// Where it takes the robot over, asks all hosts for their highest terms, all at the same time. Blocks
  /// until `deadline` at most. Called before everything below, once.
  void choose_term(TimePoint deadline);
  /// With which a host is asked first. One that has not told its terms is not taken over: whether others have
  /// a higher one there is not known.
  [[nodiscard]] RobotRequest first(const Site& site) const;
  /// With which a host is asked again: only what its user has asked for takes the robot from another runtime.
  [[nodiscard]] RobotRequest later() const;

 private:
  const Sites& sites_;
  RobotRequest request_;
  std::set<const Site*> told_;
};

}  // namespace segue::distributed::detail
