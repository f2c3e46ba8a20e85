// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/model/component.hpp>
#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>

/// Transitions between networks (Wirkus et al. 2020, Algorithm 1, corrected). Pure functions: no threads, no
/// I/O, no clock. Linear in the size of the networks.
namespace segue::solve {

struct Options {
  model::Order order = model::Order::Seamless;
  /// Whether whoever executes can have two incarnations of a task that moves to another process. If not, the
  /// new one waits until the old one is gone: in commit.
  bool side_by_side = true;
  /// Processes that go are killed (DeploymentAction::kill) before all else, and nothing is done in them or to
  /// connections with them. Not graceful: their tasks cannot tidy up. For what hangs.
  bool force = false;
};

/// The minimal transition (under graceful semantics, but for `force`) from what runs (`current`: a network
/// whose tasks may be in any state) to `target` (tasks PreOperational, Stopped or Running, or in the error
/// that they are in now: it stays). Both must have passed validation of structure; components that `catalog`
/// lacks count as having static ports and no live properties. Fails (Unsupported) where no transition exists:
/// a task in Fatal inside the runtime's own process, or one whose error is to stay where it cannot.
Result<model::Transition> diff(const model::Network& current, const model::Network& target,
                               const model::ComponentCatalog& catalog, const Options& options = {});

/// The network that results when `transition` is executed on `current`: every action is checked against the
/// life cycle, in list order; the first that is not allowed is the error (its id is the subject).
Result<model::Network> predict(const model::Network& current, const model::Transition& transition,
                               const model::ComponentCatalog& catalog);

}  // namespace segue::solve
