// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/convert/mission_plan.hpp>
#include <segue/mission/globals.hpp>
#include <segue/mission/run_journal.hpp>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace segue::convert {

/// The journal of a concurrent run: which actions and opaque subtrees have begun and ended. Only what counts
/// is recorded; an opaque subtree counts as one action. For the engine's thread.
class NodeJournal {
 public:
  /// What is recorded of an execution beside its outcome, outputs and error: the value of kRecordOutput.
  [[nodiscard]] static type::Value record_of(const mission::Globals& used,
                                             const std::vector<std::string>& facts);

  NodeJournal(const MissionPlan& plan, std::shared_ptr<mission::RunJournal> journal)
      : plan_(plan), journal_(std::move(journal)) {}

  /// How the node ended in the earlier run, or is taken to have ended; nothing if it is to be executed.
  [[nodiscard]] std::optional<mission::RunJournal::End> recorded(cdtn::NodeId node) const;
  /// The node begins as soon as this returns. On disk, if it is potentially irreversible; others are not
  /// recorded, since they may be discarded.
  void began(cdtn::NodeId node);
  /// The end counts.
  void ended(cdtn::NodeId node, cdtn::OutcomeId outcome, const type::Value* outputs);
  /// The mission has ended, so that there is nothing to resume.
  void finished(const std::string& outcome);

 private:
  [[nodiscard]] bool records(cdtn::NodeId node) const;
  [[nodiscard]] mission::Execution execution(cdtn::NodeId node) const;

  const MissionPlan& plan_;
  const std::shared_ptr<mission::RunJournal> journal_;
};

}  // namespace segue::convert
