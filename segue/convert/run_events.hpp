// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/convert/concurrent_run.hpp>
#include <segue/convert/mission_plan.hpp>
#include <segue/mission_engine/retry_watch.hpp>

#include <functional>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace segue::convert {

/// Tells the followers of a concurrent run which states begin and end (RunOptions::observe) and how many
/// units they have left (RunOptions::observe_units), and warns of states that abort again and again. For the
/// engine's thread.
class RunEvents {
 public:
  RunEvents(MissionPlan& plan, const RunOptions& options);

  /// An action or an opaque subtree begins, at `now`; the subtree tells of its own states.
  void begins(task_network::NodeId node, TimePoint now);
  /// The end of the node will be replayed from the run that is being resumed, so nobody is told of it.
  void replays(task_network::NodeId node) {
    replayed_.insert(node);
    note_units(node);
  }
  /// The node's end counts. To be called before the plan is told of it. `outputs` may be null.
  void ended(task_network::NodeId node, task_network::OutcomeId outcome, const type::Value* outputs);
  /// Tells of containers that have ended, after the plan has changed.
  void settle();
  /// The run has ended: tells of the states that have ended with it.
  void finish(const task_network::RunResult& result);

 private:
  void begin_containers(std::shared_ptr<ContainerRun> innermost);
  void note_units(task_network::NodeId node);
  void tell_units(task_network::NodeId node, task_network::OutcomeId outcome, const type::Value* outputs);
  [[nodiscard]] bool is_told(task_network::NodeId node, task_network::OutcomeId outcome) const;
  void tell_end(task_network::NodeId node, task_network::OutcomeId ending, const type::Value* outputs);
  void tell_end(const ContainerRun& container, mission::Outcome outcome, std::string_view error);
  void tell_failed(task_network::NodeId node, std::string_view error);

  MissionPlan& plan_;
  const mission::StateObserver observe_;       ///< null: nobody follows
  const mission::UnitObserver observe_units_;  ///< null: nobody follows
  const bool can_be_resumed_;
  const std::function<void(std::string)> warn_;
  mission::RetryWatch retries_;
  TimePoint latest_;                            ///< when an action or a subtree began last
  std::set<task_network::NodeId> replayed_;     ///< and not ended
  std::set<task_network::NodeId> using_units_;  ///< that have begun, and of which no end counts yet
  std::set<task_network::NodeId> lost_;  ///< preempted by other states of their containers, and reported
  std::vector<std::shared_ptr<ContainerRun>> begun_;  ///< and not ended; the outer ones first
};

}  // namespace segue::convert
