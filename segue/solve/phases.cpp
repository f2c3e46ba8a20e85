// SPDX-License-Identifier: Apache-2.0
#include <segue/solve/order.hpp>

namespace segue::solve::detail {

namespace {

using model::ActionKind;
using model::Phase;

/// The phase of an action as far as its own subject is concerned.
class Wishes {
 public:
  Wishes(const Plan& plan, const Index& index, const Constraints& constraints)
      : plan_(plan), index_(index), constraints_(constraints) {}

  [[nodiscard]] Phase of(const Node& node) const {
    switch (node.kind) {
      case ActionKind::Recover:
      case ActionKind::Cleanup:
        return has_old(plan_.task(node.subject).fate) ? Phase::Retire : Phase::Commit;
      case ActionKind::Undeploy:  // which stops what runs if it kills
        return plan_.options.force ? Phase::Commit : Phase::Retire;
      case ActionKind::Deploy:
        return Phase::Prepare;
      case ActionKind::ApplyConfig:
      case ActionKind::Configure:
        return is_beside(node.subject) ? Phase::Prepare : Phase::Commit;
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
  [[nodiscard]] bool is_beside(int task) const {
    return has_new(plan_.task(task).fate) && !constraints_.in_place[as_index(task)];
  }

  [[nodiscard]] bool joins_new(int number) const {
    const Wire& wire = index_.wires[kTarget][as_index(number)];
    return is_beside(wire.from) && is_beside(wire.to);
  }

  /// Nobody reads from it any more once its reader is stopped; what a reader that stays has of an old writer
  /// must be gone before the new one starts.
  [[nodiscard]] bool reader_goes(int number) const {
    return has_old(plan_.task(index_.wires[kCurrent][as_index(number)].to).fate);
  }

  const Plan& plan_;
  const Index& index_;
  const Constraints& constraints_;
};

}  // namespace

void assign_phases(Nodes& nodes, const Plan& plan, const Index& index, const Constraints& constraints,
                   const Predecessors& before, const std::vector<int>& order) {
  const Wishes wishes(plan, index, constraints);
  std::vector<Node>& list = nodes.list;
  // Nothing is prepared that waits for what is not.
  for (const int i : order) {
    Phase& phase = list[as_index(i)].phase;
    phase = wishes.of(list[as_index(i)]);
    if (phase != Phase::Prepare) continue;
    for (const int* node = before.begin(i); node != before.end(i); ++node) {
      if (list[as_index(*node)].phase != Phase::Prepare) phase = Phase::Commit;
    }
  }
  // Nothing is retired that something else waits for.
  for (auto i = order.rbegin(); i != order.rend(); ++i) {
    if (list[as_index(*i)].phase == Phase::Retire) continue;
    for (const int* node = before.begin(*i); node != before.end(*i); ++node) {
      Phase& phase = list[as_index(*node)].phase;
      if (phase == Phase::Retire) phase = Phase::Commit;
    }
  }
}

}  // namespace segue::solve::detail
