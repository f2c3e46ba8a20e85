// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/transition.hpp>
#include <segue/solve/plan.hpp>
#include <segue/solve/sequence.hpp>
#include <segue/solve/transition_index.hpp>

#include <array>
#include <vector>

/// Orders the actions: the partial order, the phases and the list order.
namespace segue::solve::detail {

/// An action to be; `subject` is the number of its task, process or connection.
struct ActionNode {
  model::ActionKind kind;
  model::Phase phase;
  int subject;
};

/// The actions in the paper's order, with indices to find each of them.
struct ActionNodes {
  std::vector<ActionNode> list;
  std::vector<std::array<int, 11>> of_task;  ///< by kind; kNone: no such action
  std::vector<int> undeploy, deploy;         ///< per process
  std::vector<int> disconnect;               ///< per connection of the current network
  std::vector<int> connect;                  ///< per connection of the target
  /// Where samples flow meanwhile, producers stop before consumers, which start before producers.
  std::vector<OrderEdge> start_and_stop;

  [[nodiscard]] int of(int task, model::ActionKind kind) const {
    return of_task[as_index(task)][static_cast<std::size_t>(kind)];
  }
};
ActionNodes make_nodes(const Index& index, const ChangeSet& plan);

/// Everything that breaks without an order, linear in number: edges from earlier to later nodes of the list,
/// but for those of hand-overs, which may even form cycles.
/// Where a new incarnation takes the place of an old one, `in_place` is the task of the old one, else kNone.
struct Constraints {
  std::vector<OrderEdge> edges;
  std::vector<int> in_place;
};
Constraints find_constraints(const Index& index, const ChangeSet& plan, const ActionNodes& nodes);

/// Drops hand-overs that no order allows: the new task needs the placement or a device of the old one, so the
/// old one is cleaned up first. Returns whether any was dropped.
bool drop_impossible_hand_overs(ChangeSet& plan, const ActionNodes& nodes, const Constraints& constraints);

/// Actions that leave the old network untouched are Prepare, those that the new network does not wait for are
/// Retire, all others Commit. No edge leads from a later phase to an earlier one. `order` holds all nodes,
/// each after those before it.
void assign_phases(ActionNodes& nodes, const ChangeSet& plan, const Index& index,
                   const Constraints& constraints, const Predecessors& before, const std::vector<int>& order);

}  // namespace segue::solve::detail
