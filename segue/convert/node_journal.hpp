// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/convert/mission_plan.hpp>
#include <segue/mission/globals.hpp>
#include <segue/mission_engine/run_journal.hpp>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace segue::convert {

/// The changes that an opaque subtree has made beside its outputs and variables, as in
/// mission::RunJournal::End.
struct SubtreeChanges {
  std::vector<std::string> facts{};
  mission::UnitChanges units{};
  std::map<mission::StateIndex, std::uint32_t> begun{};
  type::ValueMap values{};  ///< of the world, all that it may change
};

/// The journal of a concurrent run: which actions and opaque subtrees have begun and ended. Only what counts
/// is recorded; an opaque subtree counts as one action. For the engine's thread.
class NodeJournal {
 public:
  /// The record of an execution beside its outcome, outputs and error: the value of kRecordOutput.
  [[nodiscard]] static type::Value record_of(const mission::Globals& used, const SubtreeChanges& changes);

  NodeJournal(const MissionPlan& plan, std::shared_ptr<mission::RunJournal> journal);

  /// How the node, which begins now, ended in the earlier run, or is taken to have ended; nothing if it is to
  /// be executed.
  [[nodiscard]] std::optional<mission::RunJournal::End> replayed(task_network::NodeId node);
  /// Whether the node had begun in the earlier run, as far as the journal says; of containers it does not,
  /// and those count as begun that begin before all in the journal has.
  [[nodiscard]] bool had_begun(task_network::NodeId node) const;
  /// The node does not begin, and aborts, as it did in the earlier run if that had come so far.
  void refused(task_network::NodeId node);
  /// The node begins as soon as this returns. On disk, if it is potentially irreversible; others are not
  /// recorded, since they may be discarded.
  void began(task_network::NodeId node);
  /// The progress of an earlier run with this node, and the function that records progress, as of
  /// mission::ActionCall::progress() and recorder().
  [[nodiscard]] const type::Value& progress(task_network::NodeId node) const {
    return journal_->progress(execution(node));
  }
  [[nodiscard]] std::function<void(const type::Value&)> recorder(task_network::NodeId node) const;
  /// The end counts.
  void ended(task_network::NodeId node, task_network::OutcomeId outcome, const type::Value* outputs);
  /// The earlier run's records of preemptive containers, and the function by which this run records them.
  [[nodiscard]] RaceRecord races() const;
  /// The mission has ended, so that there is nothing to resume.
  void finished(const std::string& outcome);

 private:
  [[nodiscard]] bool records(task_network::NodeId node) const;
  [[nodiscard]] std::string name_of_action(task_network::NodeId node) const;
  [[nodiscard]] mission::Execution execution(task_network::NodeId node) const;
  [[nodiscard]] bool awaits(const mission::Execution& state) const;

  const MissionPlan& plan_;
  const std::shared_ptr<mission::RunJournal> journal_;
  std::set<mission::Execution> awaited_;  ///< recorded, and neither begun nor refused in this run
};

}  // namespace segue::convert
