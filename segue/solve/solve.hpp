// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>

#include <map>
#include <set>

/// Transitions between networks (Wirkus et al. 2020, Algorithm 1, corrected). Pure functions: no threads, no
/// I/O, no clock. Linear in the size of the networks.
namespace segue::solve {

/// How a transition is computed.
struct Options {
  model::Order order = model::Order::Seamless;
  /// Whether the host can hold two incarnations of a task that moves to another process. If not, the new one
  /// is created in the commit phase, after the old one has been removed.
  bool side_by_side = true;
  /// Removed processes are killed (DeploymentAction::kill) before all other actions, without any action on
  /// their tasks and connections. Not graceful: their tasks cannot clean up. For processes that hang.
  bool force = false;
  /// Tasks of `current` that are not part of the running network: standby tasks, and leftovers of earlier
  /// requests. Actions on these alone disturb no task that runs, so prepare may do them.
  std::set<model::TaskId> idle = {};
  /// Tasks of `target` whose next incarnation exists already: the task of `target`, and the idle task of
  /// `current` that lives where `target` places it. A task of `current` with the target's id is the
  /// incarnation that it replaces.
  std::map<model::TaskId, model::TaskId> prepared = {};
};

/// The minimal transition from `current`, whose tasks may be in any state, to `target`, whose tasks are
/// PreOperational, Stopped or Running, or keep the error that they are in. Minimal under graceful semantics,
/// unless with `force`. Both networks must have passed validation of structure; unknown components are
/// assumed to have static ports and no live properties. Fails (Unsupported) if there is no transition: for a
/// target that needs a task, or a device of a task, in Fatal in the runtime's own process, or that keeps an
/// error which the transition has to end.
Result<model::Transition> diff(const model::Network& current, const model::Network& target,
                               const model::ComponentCatalog& catalog, const Options& options = {});

/// The network that results from executing `transition` on `current`. Checks every action against the life
/// cycle, in list order, and calls also against what their components say of the operation and its arguments;
/// the first one that is not allowed is the error, with its id as subject.
Result<model::Network> predict(const model::Network& current, const model::Transition& transition,
                               const model::ComponentCatalog& catalog);

}  // namespace segue::solve
