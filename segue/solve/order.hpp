// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/transition.hpp>
#include <segue/solve/index.hpp>
#include <segue/solve/plan.hpp>
#include <segue/solve/sequence.hpp>

#include <array>
#include <vector>

/// In which order, and what may run beside what.
namespace segue::solve::detail {

/// An action to be; `subject` is the number of its task, process or wire.
struct Node {
  model::ActionKind kind;
  model::Phase phase;
  int subject;
};

/// The actions of a plan in the paper's order, and where each is found.
struct Nodes {
  std::vector<Node> list;
  std::vector<std::array<int, 11>> of_task;  ///< by kind; kNone: no such action
  std::vector<int> undeploy, deploy;         ///< per process
  std::vector<int> disconnect;               ///< per wire of the current network
  std::vector<int> connect;                  ///< per wire of the target
  std::vector<Edge> start_and_stop;  ///< producers stop before consumers, which start before producers

  [[nodiscard]] int of(int task, model::ActionKind kind) const {
    return of_task[as_index(task)][static_cast<std::size_t>(kind)];
  }
};
Nodes make_nodes(const Index& index, const Plan& plan);

/// Everything that breaks without an order, linear in number: edges from earlier to later nodes of the list,
/// but for those of hand-overs, which may even form cycles.
/// Where a new incarnation takes the place of an old one, `in_place` becomes true for its task.
struct Constraints {
  std::vector<Edge> edges;
  std::vector<bool> in_place;
};
Constraints find_constraints(const Index& index, const Plan& plan, const Nodes& nodes);

/// Drops the hand-overs that no order of actions allows: what takes the state needs the old task's place or
/// device, so that the old one is cleaned up first. True if there were such.
bool drop_impossible_hand_overs(Plan& plan, const Nodes& nodes, const Constraints& constraints);

/// Prepare what leaves the old network untouched, retire what the new network does not wait for; all else is
/// commit. No edge leads from a later phase to an earlier one. `order` holds all nodes, each after those
/// before it.
void assign_phases(Nodes& nodes, const Plan& plan, const Index& index, const Constraints& constraints,
                   const Predecessors& before, const std::vector<int>& order);

}  // namespace segue::solve::detail
