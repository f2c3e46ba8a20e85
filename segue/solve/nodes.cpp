// SPDX-License-Identifier: Apache-2.0
#include <segue/solve/action_order.hpp>

#include <numeric>

namespace segue::solve::detail {

namespace {

using model::ActionKind;

class Lister {
 public:
  Lister(const Index& index, const ChangeSet& plan) : index_(index), plan_(plan) {
    std::array<int, 11> none;
    none.fill(kNone);
    nodes_.of_task.assign(index.tasks.size(), none);
    nodes_.undeploy.assign(index.processes.size(), kNone);
    nodes_.deploy.assign(index.processes.size(), kNone);
    nodes_.disconnect.assign(index.connections[kCurrent].size(), kNone);
    nodes_.connect.assign(index.connections[kTarget].size(), kNone);
    current_order_.resize(index.current_tasks);
    std::iota(current_order_.begin(), current_order_.end(), 0);
  }

  /// The kinds in their order; see ActionKind. With `force`, processes are killed before all other actions.
  ActionNodes list() {
    if (plan_.options.force) add_undeploys();
    add_tasks(ActionKind::Recover, current_order_);
    add_sequence(ActionKind::Stop, current_order_);
    add_connection(ActionKind::Disconnect, plan_.disconnect, nodes_.disconnect);
    add_tasks(ActionKind::Cleanup, current_order_);
    if (!plan_.options.force) add_undeploys();
    add_processes(ActionKind::Deploy, index_.process_order[kTarget], is_deployed, nodes_.deploy);
    add_tasks(ActionKind::ApplyConfig, index_.target_order);
    add_tasks(ActionKind::Configure, index_.target_order);
    add_connection(ActionKind::Connect, plan_.connect, nodes_.connect);
    add_tasks(ActionKind::HandOver, index_.target_order);
    add_sequence(ActionKind::Start, index_.target_order);
    return std::move(nodes_);
  }

 private:
  void add_undeploys() {
    add_processes(ActionKind::Undeploy, index_.process_order[kCurrent], is_undeployed, nodes_.undeploy);
  }

  int add(ActionKind kind, int subject) {
    nodes_.list.push_back({kind, model::Phase::Commit, subject});
    return static_cast<int>(nodes_.list.size()) - 1;
  }

  int& slot(int task, ActionKind kind) {
    return nodes_.of_task[as_index(task)][static_cast<std::size_t>(kind)];
  }

  void add_tasks(ActionKind kind, const std::vector<int>& order) {
    for (const int task : order) {
      if (plan_.task(task).steps.has(kind)) slot(task, kind) = add(kind, task);
    }
  }

  void add_connection(ActionKind kind, const std::vector<bool>& wanted, std::vector<int>& nodes) {
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      if (wanted[i]) nodes[i] = add(kind, static_cast<int>(i));
    }
  }

  void add_processes(ActionKind kind, const std::vector<int>& order, bool (*wanted)(ProcessFate),
                     std::vector<int>& nodes) {
    for (const int process : order) {
      if (wanted(plan_.process(process))) nodes[as_index(process)] = add(kind, process);
    }
  }

  /// Stop: producers before their consumers. Start: consumers before their producers.
  void add_sequence(ActionKind kind, const std::vector<int>& order) {
    std::vector<int> members;
    for (const int task : order) {
      if (!plan_.task(task).steps.has(kind)) continue;
      slot(task, kind) = static_cast<int>(members.size());
      members.push_back(task);
    }
    const std::vector<OrderEdge> flow = flow_between(kind);
    const GroupedOrder found = sequence(static_cast<int>(members.size()), flow);
    const int first = static_cast<int>(nodes_.list.size());
    for (const int member : found.nodes) {
      const int task = members[as_index(member)];
      slot(task, kind) = add(kind, task);
    }
    const auto node_of = [&](int member) { return slot(members[as_index(member)], kind); };
    for (const OrderEdge& edge : flow) {
      if (found.group_of[as_index(edge.before)] == found.group_of[as_index(edge.after)]) continue;
      nodes_.start_and_stop.push_back({node_of(edge.before), node_of(edge.after)});
    }
    chain_groups(found, first);
  }

  /// Tasks in a cycle are ordered as declared.
  void chain_groups(const GroupedOrder& found, int first) {
    for (std::size_t i = 1; i < found.nodes.size(); ++i) {
      const bool same_group =
          found.group_of[as_index(found.nodes[i])] == found.group_of[as_index(found.nodes[i - 1])];
      const int node = first + static_cast<int>(i);
      if (same_group) nodes_.start_and_stop.push_back({node - 1, node});
    }
  }

  /// The connections between members, whose numbers stand in their slots. In the seamless order only those
  /// that carry samples while tasks start or stop: others begin or end with the commit.
  std::vector<OrderEdge> flow_between(ActionKind kind) {
    const bool stop = kind == ActionKind::Stop;
    const auto& connections = index_.connections[stop ? kCurrent : kTarget];
    const std::vector<bool>& changes = stop ? plan_.disconnect : plan_.connect;
    const bool seamless = plan_.options.order == model::Order::Seamless;
    std::vector<OrderEdge> flow;
    for (std::size_t i = 0; i < connections.size(); ++i) {
      if (seamless && changes[i]) continue;
      const IndexedConnection& connection = connections[i];
      const int from = slot(connection.from, kind);
      const int to = slot(connection.to, kind);
      if (from == kNone || to == kNone || from == to || (stop && !exists(index_, connection))) continue;
      flow.push_back(stop ? OrderEdge{from, to} : OrderEdge{to, from});
    }
    return flow;
  }

  const Index& index_;
  const ChangeSet& plan_;
  std::vector<int> current_order_;
  ActionNodes nodes_;
};

}  // namespace

ActionNodes make_nodes(const Index& index, const ChangeSet& plan) {
  return Lister(index, plan).list();
}

}  // namespace segue::solve::detail
