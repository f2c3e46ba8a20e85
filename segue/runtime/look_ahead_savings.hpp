// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/journal/entries.hpp>
#include <segue/model/action_times.hpp>
#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>
#include <segue/runtime/planning.hpp>
#include <segue/runtime/switch_result.hpp>
#include <segue/task_host/task_host.hpp>

#include <map>
#include <optional>
#include <string>

namespace segue::runtime::detail {

/// The networks of the robot before a transition.
struct BeforeTransition {
  model::Network current;     ///< all of it, as observed
  model::Network controller;  ///< the part that ran
  model::Network standby;     ///< the part that was kept on standby on purpose
};

/// `current` as it would be if none of the standby tasks of `wanted` had been prepared: without them, their
/// connections, and processes that hold nothing else.
model::Network without_prepared(const BeforeTransition& before, const model::Network& wanted);

/// Finds out what look-ahead saves: a transition is compared with the one that would have led from a network
/// without what had been prepared to the same target. Used by one thread; nothing blocks.
class LookAheadSavings {
 public:
  /// Remembers how long the actions took, whatever the transition was for.
  void learn(const SwitchResult& result);
  /// Of a transition that is done, whose actions have been learned. `known` is used for actions that were not
  /// executed since this exists. Nothing where no task was found ready. Takes as long as solving.
  [[nodiscard]] std::optional<journal::PreparedAhead> of(const SwitchResult& result,
                                                         const BeforeTransition& before,
                                                         const SwitchPlan& plan,
                                                         const task_host::TaskHost& host,
                                                         const model::ComponentCatalog& catalog,
                                                         const model::ActionTimes& known) const;

 private:
  std::map<std::string, Duration> measured_;  ///< the latest of each action, by its label
};

}  // namespace segue::runtime::detail
