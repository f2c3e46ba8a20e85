// SPDX-License-Identifier: Apache-2.0
#include <segue/solve/order.hpp>

namespace segue::solve::detail {

namespace {

using model::ActionKind;
using model::Phase;

/// The phase of an action, considering its subject only.
class PhaseRule {
 public:
  PhaseRule(const ChangeSet& plan, const Index& index, const Constraints& constraints)
      : plan_(plan), index_(index), constraints_(constraints) {}

  [[nodiscard]] Phase of(const ActionNode& node) const {
    switch (node.kind) {
      case ActionKind::Recover:
      case ActionKind::Cleanup:
        return has_old(plan_.task(node.subject).fate) ? Phase::Retire : Phase::Commit;
      case ActionKind::Undeploy:  // killing a process stops its running tasks
        return plan_.options.force ? Phase::Commit : Phase::Retire;
      case ActionKind::Deploy:
        return Phase::Prepare;
      case ActionKind::ApplyConfig:
      case ActionKind::Configure:
        return can_coexist(node.subject) ? Phase::Prepare : Phase::Commit;
      case ActionKind::Connect:
        return joins_new(node.subject) ? Phase::Prepare : Phase::Commit;
      case ActionKind::Disconnect:
        return reader_goes(node.subject) ? Phase::Retire : Phase::Commit;
      case ActionKind::Stop:
      case ActionKind::HandOver:
      case ActionKind::Start:
      case ActionKind::CallOperation:
        break;
    }
    return Phase::Commit;
  }

 private:
  /// A new incarnation that can exist while the old network runs.
  [[nodiscard]] bool can_coexist(int task) const {
    return has_new(plan_.task(task).fate) && !constraints_.in_place[as_index(task)];
  }

  [[nodiscard]] bool joins_new(int number) const {
    const IndexedConnection& connection = index_.connections[kTarget][as_index(number)];
    return can_coexist(connection.from) && can_coexist(connection.to);
  }

  /// A connection to a removed reader is unused once that is stopped. A reader that stays must be
  /// disconnected from the old writer before the new writer starts.
  [[nodiscard]] bool reader_goes(int number) const {
    return has_old(plan_.task(index_.connections[kCurrent][as_index(number)].to).fate);
  }

  const ChangeSet& plan_;
  const Index& index_;
  const Constraints& constraints_;
};

}  // namespace

void assign_phases(ActionNodes& nodes, const ChangeSet& plan, const Index& index,
                   const Constraints& constraints, const Predecessors& before,
                   const std::vector<int>& order) {
  const PhaseRule rule(plan, index, constraints);
  std::vector<ActionNode>& list = nodes.list;
  // An action that waits for one outside of Prepare cannot be in Prepare.
  for (const int i : order) {
    Phase& phase = list[as_index(i)].phase;
    phase = rule.of(list[as_index(i)]);
    if (phase != Phase::Prepare) continue;
    for (const int* node = before.begin(i); node != before.end(i); ++node) {
      if (list[as_index(*node)].phase != Phase::Prepare) phase = Phase::Commit;
    }
  }
  // An action that one outside of Retire waits for cannot be in Retire.
  for (auto i = order.rbegin(); i != order.rend(); ++i) {
    if (list[as_index(*i)].phase == Phase::Retire) continue;
    for (const int* node = before.begin(*i); node != before.end(*i); ++node) {
      Phase& phase = list[as_index(*node)].phase;
      if (phase == Phase::Retire) phase = Phase::Commit;
    }
  }
}

}  // namespace segue::solve::detail
