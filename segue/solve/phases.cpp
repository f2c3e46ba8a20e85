// SPDX-License-Identifier: Apache-2.0
#include <segue/solve/action_order.hpp>

namespace segue::solve::detail {

namespace {

using model::ActionKind;
using model::Phase;

/// The phase of an action, considering its subject only.
class PhaseRule {
 public:
  PhaseRule(const ChangeSet& plan, const Index& index, const Constraints& constraints)
      : plan_(plan), index_(index), constraints_(constraints) {
    if (!plan.options.idle.empty()) find_idle_processes();
  }

  [[nodiscard]] Phase of(const ActionNode& node) const {
    switch (node.kind) {
      case ActionKind::Recover:
      case ActionKind::Cleanup:
        if (has_old(plan_.task(node.subject).fate)) return Phase::Retire;
        return is_idle(node.subject) ? Phase::Prepare : Phase::Commit;
      case ActionKind::Undeploy:  // killing a process stops its running tasks
        return plan_.options.force ? Phase::Commit : Phase::Retire;
      case ActionKind::Deploy:
        return Phase::Prepare;
      case ActionKind::ApplyConfig:
      case ActionKind::Configure:
        return can_coexist(node.subject) ? Phase::Prepare : Phase::Commit;
      case ActionKind::Connect:  // begins with the commit
        return Phase::Prepare;
      case ActionKind::Disconnect:  // ends with the commit
        return joins_idle(node.subject) ? Phase::Prepare : Phase::Retire;
      case ActionKind::Stop:  // what goes, or need not run any more; a task that changes has to stop in
                              // Commit
        return Phase::Retire;
      case ActionKind::HandOver:
      case ActionKind::Start:
      case ActionKind::CallOperation:
        break;
    }
    return Phase::Commit;
  }

  /// Whether the action concerns idle tasks only, so that it may be done in prepare if something there needs
  /// it.
  [[nodiscard]] bool is_harmless(const ActionNode& node) const {
    switch (node.kind) {
      case ActionKind::Recover:
      case ActionKind::Cleanup:
        return is_idle(node.subject);
      case ActionKind::Disconnect:
        return joins_idle(node.subject);
      case ActionKind::Undeploy:
        return idle_processes_[as_index(node.subject)];
      default:
        return false;
    }
  }

 private:
  [[nodiscard]] bool is_idle(int task) const { return index_.task(task).idle; }

  [[nodiscard]] bool joins_idle(int number) const {
    const IndexedConnection& connection = index_.connections[kCurrent][as_index(number)];
    return is_idle(connection.from) && is_idle(connection.to);
  }

  /// Finds the processes that hold idle tasks only. An empty process may belong to the running network.
  void find_idle_processes() {
    idle_processes_.resize(index_.processes.size());
    for (const bool idle : {true, false}) {
      for (std::size_t i = 0; i < index_.current_tasks; ++i) {
        const IndexedTask& task = index_.tasks[i];
        if (task.idle == idle) idle_processes_[as_index(task.current().process)] = idle;
      }
    }
  }

  /// A new incarnation, or an idle task, that can be what the target wants while the old network runs.
  [[nodiscard]] bool can_coexist(int task) const {
    if (is_idle(task)) return index_.task(task).target().task != nullptr;
    const int occupant = constraints_.in_place[as_index(task)];
    return has_new(plan_.task(task).fate) && (occupant == kNone || is_idle(occupant));
  }

  const ChangeSet& plan_;
  const Index& index_;
  const Constraints& constraints_;
  std::vector<bool> idle_processes_;
};

/// An action that waits for one outside of Prepare cannot be in Prepare.
void keep_out_of_prepare(std::vector<ActionNode>& list, const Predecessors& before,
                         const std::vector<int>& order) {
  for (const int i : order) {
    Phase& phase = list[as_index(i)].phase;
    if (phase != Phase::Prepare) continue;
    for (const int* node = before.begin(i); node != before.end(i); ++node) {
      if (list[as_index(*node)].phase != Phase::Prepare) phase = Phase::Commit;
    }
  }
}

/// An action that one outside of Retire waits for cannot be in Retire.
void keep_out_of_retire(std::vector<ActionNode>& list, const Predecessors& before,
                        const std::vector<int>& order) {
  for (auto i = order.rbegin(); i != order.rend(); ++i) {
    if (list[as_index(*i)].phase == Phase::Retire) continue;
    for (const int* node = before.begin(*i); node != before.end(*i); ++node) {
      Phase& phase = list[as_index(*node)].phase;
      if (phase == Phase::Retire) phase = Phase::Commit;
    }
  }
}

}  // namespace

void assign_phases(ActionNodes& nodes, const ChangeSet& plan, const Index& index,
                   const Constraints& constraints, const Predecessors& before,
                   const std::vector<int>& order) {
  const PhaseRule rule(plan, index, constraints);
  std::vector<ActionNode>& list = nodes.list;
  for (ActionNode& node : list)
    node.phase = rule.of(node);
  // Idle tasks are in nobody's way, so all changes that Prepare needs of them are made there.
  for (auto i = order.rbegin(); i != order.rend() && !plan.options.idle.empty(); ++i) {
    if (list[as_index(*i)].phase != Phase::Prepare) continue;
    for (const int* node = before.begin(*i); node != before.end(*i); ++node) {
      if (rule.is_harmless(list[as_index(*node)])) list[as_index(*node)].phase = Phase::Prepare;
    }
  }
  keep_out_of_prepare(list, before, order);
  keep_out_of_retire(list, before, order);
}

}  // namespace segue::solve::detail
