// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/convert/mission_plan.hpp>
#include <segue/convert/run.hpp>
#include <segue/mission/retry_watch.hpp>

#include <functional>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace segue::convert {

/// Tells whoever follows a concurrent run which states begin and end (RunOptions::observe), and warns of
/// states that abort again and again. For the engine's thread.
class RunEvents {
 public:
  RunEvents(MissionPlan& plan, const RunOptions& options);

  /// An action or an opaque subtree begins, which tells of itself.
  void begins(cdtn::NodeId node);
  /// Its end will be as in the run that is being resumed, which nobody is told.
  void replays(cdtn::NodeId node) { replayed_.insert(node); }
  /// Its end counts. Before the plan is told of it. `outputs` may be null.
  void ended(cdtn::NodeId node, cdtn::OutcomeId outcome, const type::Value* outputs);
  /// Tells of containers that have ended, after the plan has changed.
  void settle();
  /// The run has ended: tells of what has ended with it.
  void finish(const cdtn::RunResult& result);

 private:
  void begin_containers(std::shared_ptr<ContainerRun> innermost);
  [[nodiscard]] bool is_told(cdtn::NodeId node, cdtn::OutcomeId outcome) const;
  void tell_end(cdtn::NodeId node, cdtn::OutcomeId ending, const type::Value* outputs);
  void tell_end(const ContainerRun& container, mission::Outcome outcome, std::string_view error);
  void tell_failed(cdtn::NodeId node, std::string_view error);

  MissionPlan& plan_;
  const mission::StateObserver observe_;  ///< null: nobody follows
  const std::function<void(std::string)> warn_;
  mission::RetryWatch retries_;
  std::set<cdtn::NodeId> replayed_;  ///< and not ended
  std::set<cdtn::NodeId> lost_;      ///< preempted by other states of their containers, and reported
  std::vector<std::shared_ptr<ContainerRun>> begun_;  ///< and not ended; the outer ones first
};

}  // namespace segue::convert
