// SPDX-License-Identifier: Apache-2.0
#include <segue/solve/action_order.hpp>
#include <segue/solve/plan.hpp>
#include <segue/solve/solve.hpp>
#include <segue/solve/transition_index.hpp>

#include <algorithm>
#include <numeric>
#include <utility>

namespace segue::solve {

namespace {

using namespace detail;
using model::Action;
using model::ActionKind;
using model::Phase;

model::DeploymentKey key_of(const Index& index, int process) {
  if (process == kRuntime) return {};
  const IndexedProcess& entry = index.process(process);
  return (entry.target() ? entry.target() : entry.current())->key();
}

/// The deployment without its tasks, which apply_config places.
model::DeploymentAction deployment_action(const Index& index, const ChangeSet& plan, const ActionNode& node) {
  const IndexedProcess& entry = index.process(node.subject);
  const model::Deployment& from = node.kind == ActionKind::Deploy ? *entry.target() : *entry.current();
  model::Deployment process = from;
  process.tasks.clear();
  return {std::move(process), node.kind == ActionKind::Undeploy && plan.options.force};
}

/// Whether it is an action on the current incarnation of a task.
bool takes_down(ActionKind kind) {
  return kind == ActionKind::Recover || kind == ActionKind::Stop || kind == ActionKind::Cleanup;
}

/// Fills in the subject of the action.
void fill(Action& action, const Index& index, const ChangeSet& plan, const ActionNode& node) {
  const auto connection = [&](Side side) -> const model::Connection& {
    return *index.connections[side][as_index(node.subject)].connection;
  };
  switch (node.kind) {
    case ActionKind::Disconnect:
      action.what.emplace<model::ConnectionAction>().connection = connection(kCurrent);
      return;
    case ActionKind::Connect:
      action.what.emplace<model::ConnectionAction>().connection = connection(kTarget);
      return;
    case ActionKind::Undeploy:
    case ActionKind::Deploy:
      action.what = deployment_action(index, plan, node);
      return;
    case ActionKind::ApplyConfig: {
      const TaskIncarnation& task = index.task(node.subject).target();
      auto& what = action.what.emplace<model::ConfigAction>();
      what.definition = *task.task;
      what.process = key_of(index, task.process);
      what.name = task.name;
      return;
    }
    case ActionKind::HandOver: {
      const IndexedTask& entry = index.task(node.subject);
      auto& what = action.what.emplace<model::HandOverAction>();
      what.from = *entry.target().task->takes_over;
      what.to = entry.target().task->id;
      return;
    }
    default: {
      const IndexedTask& entry = index.task(node.subject);
      const bool old = takes_down(node.kind) || entry.target().task == nullptr;
      const model::Task& task = *(old ? entry.current() : entry.target()).task;
      action.what.emplace<model::TaskAction>().task = task.id;
    }
  }
}

/// Appends one action at a time: actions are large, and copying them dominates the time.
Action& add_action(model::Transition& transition, const Index& index, const ChangeSet& plan,
                   const ActionNode& node) {
  Action& action = transition.actions.emplace_back();
  action.id = static_cast<int>(transition.actions.size());
  action.kind = node.kind;
  fill(action, index, plan, node);
  return action;
}

/// The nodes in the order of their phases, otherwise as in `order`.
std::vector<int> by_phase(const std::vector<ActionNode>& nodes, const std::vector<int>& order) {
  std::vector<int> sorted;
  sorted.reserve(nodes.size());
  for (const Phase phase : {Phase::Prepare, Phase::Commit, Phase::Retire}) {
    for (const int node : order) {
      if (nodes[as_index(node)].phase == phase) sorted.push_back(node);
    }
  }
  return sorted;
}

/// A topological order of all nodes: their list order, unless a hand-over must precede the cleanup of the old
/// task.
std::vector<int> executable_order(const ChangeSet& plan, const ActionNodes& nodes,
                                  const Constraints& constraints) {
  const int count = static_cast<int>(nodes.list.size());
  if (plan.hands_over) return sequence(count, constraints.edges).nodes;
  std::vector<int> order(nodes.list.size());
  std::iota(order.begin(), order.end(), 0);
  return order;
}

std::vector<int> ids_before(const Predecessors& before, int node, const std::vector<int>& id_of) {
  std::vector<int> ids;
  ids.reserve(static_cast<std::size_t>(before.end(node) - before.begin(node)));
  for (const int* other = before.begin(node); other != before.end(node); ++other) {
    ids.push_back(id_of[as_index(*other)]);
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

void order_seamlessly(model::Transition& transition, const Index& index, ChangeSet& plan,
                      ActionNodes& nodes) {
  Constraints constraints = find_constraints(index, plan, nodes);
  if (plan.hands_over && drop_impossible_hand_overs(plan, nodes, constraints)) {
    nodes = make_nodes(index, plan);
    constraints = find_constraints(index, plan, nodes);
  }
  const std::vector<int> listed = executable_order(plan, nodes, constraints);
  const Predecessors before(static_cast<int>(nodes.list.size()), constraints.edges);
  assign_phases(nodes, plan, index, constraints, before, listed);
  const std::vector<int> order = by_phase(nodes.list, listed);
  std::vector<int> id_of(order.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    id_of[as_index(order[i])] = static_cast<int>(i) + 1;
  transition.actions.reserve(order.size());
  for (const int number : order) {
    const ActionNode& node = nodes.list[as_index(number)];
    Action& action = add_action(transition, index, plan, node);
    action.phase = node.phase;
    action.after = ids_before(before, number, id_of);
  }
}

/// The paper's sequential execution: each action waits for the previous one, and all are in Commit.
void order_as_paper(model::Transition& transition, const Index& index, const ChangeSet& plan,
                    const ActionNodes& nodes) {
  transition.actions.reserve(nodes.list.size());
  for (const ActionNode& node : nodes.list) {
    Action& action = add_action(transition, index, plan, node);
    if (action.id > 1) action.after.push_back(action.id - 1);
  }
}

void list_silent_changes(model::Transition& transition, const Index& index, const ChangeSet& plan) {
  for (std::size_t i = 0; i < index.current_tasks; ++i) {
    if (plan.tasks[i].fate == TaskFate::Removed && !index.tasks[i].is_replaced) {
      transition.removes.push_back(index.tasks[i].current().task->id);
    }
  }
  for (const int number : index.target_order) {
    const IndexedTask& entry = index.task(number);
    if (plan.task(number).fate != TaskFate::Kept) continue;
    if (plan.task(number).steps.has(ActionKind::ApplyConfig)) continue;
    const model::Task& now = *entry.current().task;
    const model::Task& then = *entry.target().task;
    if (now.takes_over == then.takes_over && now.on_failure == then.on_failure) continue;
    transition.redefines.push_back(then);
  }
}

}  // namespace

Result<model::Transition> diff(const model::Network& current, const model::Network& target,
                               const model::ComponentCatalog& catalog, const Options& options) {
  auto index = build_index(current, target, catalog, options);
  if (!index) return index.error();
  auto plan = make_plan(*index, options);
  if (!plan) return plan.error();
  ActionNodes nodes = make_nodes(*index, *plan);
  model::Transition transition;
  transition.from = current.name;
  transition.to = target.name;
  transition.order = options.order;
  if (options.order == model::Order::Paper) {
    order_as_paper(transition, *index, *plan, nodes);
  } else {
    order_seamlessly(transition, *index, *plan, nodes);
  }
  list_silent_changes(transition, *index, *plan);
  return transition;
}

}  // namespace segue::solve
