// SPDX-License-Identifier: Apache-2.0
#include <segue/solve/action_order.hpp>

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <string>
#include <unordered_map>

namespace segue::solve::detail {

namespace {

using model::ActionKind;

/// The actions that release an exclusive device, and those that claim it.
struct Device {
  std::vector<int> releases;
  std::vector<int> claims;
};

class Finder {
 public:
  Finder(const Index& index, const ChangeSet& plan, const ActionNodes& nodes)
      : index_(index), plan_(plan), nodes_(nodes) {}

  Constraints find() {
    found_.edges = nodes_.start_and_stop;
    found_.in_place.assign(index_.tasks.size(), kNone);
    takers_.assign(index_.tasks.size(), kNone);
    find_places();
    for (int task = 0; as_index(task) < index_.tasks.size(); ++task)
      add_task(task);
    for (std::size_t i = 0; i < index_.processes.size(); ++i)
      add(nodes_.undeploy[i], nodes_.deploy[i]);
    for (std::size_t i = 0; i < index_.connections[kCurrent].size(); ++i)
      add_old_connection(i);
    for (std::size_t i = 0; i < nodes_.connect.size(); ++i)
      add_connect(i);
    add_devices();
    return std::move(found_);
  }

 private:
  void add(int before, int after) {
    if (before != kNone && after != kNone) found_.edges.push_back({before, after});
  }

  [[nodiscard]] int node(int task, ActionKind kind) const { return nodes_.of(task, kind); }

  /// The action that ends the task's present process.
  [[nodiscard]] int undeploy_of(int task) const {
    return nodes_.undeploy[as_index(index_.task(task).current().process)];
  }
  [[nodiscard]] bool is_killed(int task) const {
    return index_.task(task).current().task != nullptr &&
           plan_.is_killed(index_.task(task).current().process);
  }

  /// The action after which the old incarnation does not run.
  [[nodiscard]] int halt(int task) const {
    return is_killed(task) ? undeploy_of(task) : node(task, ActionKind::Stop);
  }

  /// Chains these actions of one task.
  void chain(int task, std::initializer_list<ActionKind> kinds) {
    int last = kNone;
    for (const ActionKind kind : kinds) {
      const int next = node(task, kind);
      if (next == kNone) continue;
      add(last, next);
      last = next;
    }
  }

  /// New incarnations that cannot exist beside an old one: of the same id in the same process (or anywhere,
  /// if that is all that can be executed), or in a place that another task leaves.
  void find_places() {
    std::optional<OccupantIndex> occupants;
    if (index_.tasks_renamed) occupants.emplace(index_, kCurrent);
    for (const int task : index_.target_order) {
      if (!has_new(plan_.task(task).fate)) continue;
      if (is_in_place(task)) found_.in_place[as_index(task)] = task;
      const TaskIncarnation& target = index_.task(task).target();
      if (plan_.process(target.process) != ProcessFate::Kept) continue;
      const int occupant = occupants ? occupants->find(target.process, target.name) : kNone;
      if (occupant == kNone || occupant == task) continue;
      found_.in_place[as_index(task)] = occupant;
      takers_[as_index(occupant)] = task;
    }
  }

  [[nodiscard]] bool is_in_place(int task) const {
    if (plan_.task(task).fate != TaskFate::Replaced) return false;
    const int process = index_.task(task).target().process;
    return !plan_.options.side_by_side ||
           (index_.task(task).current().process == process && plan_.process(process) == ProcessFate::Kept);
  }

  void add_task(int task) {
    const TaskPlan& plan = plan_.task(task);
    add_take_over(task);
    const int replaced = index_.task(task).replaces;
    if (replaced != kNone) add(halt(replaced), node(task, ActionKind::Start));
    if (plan.fate == TaskFate::Kept) {
      add_kept(task, plan.live);
      return;
    }
    if (has_old(plan.fate)) add_old(task);
    if (has_new(plan.fate)) add_new(task);
  }

  /// A live configuration fits any configured state, but a task must not start with the old one.
  void add_kept(int task, bool live) {
    using enum ActionKind;
    if (live) {
      chain(task, {ApplyConfig, HandOver, Start});
    } else {
      chain(task, {Recover, Stop, Cleanup, ApplyConfig, Configure, HandOver, Start});
    }
  }

  void add_old(int task) {
    using enum ActionKind;
    chain(task, {Stop, Cleanup});
    before_it_vanishes(task, node(task, Cleanup));
    before_it_vanishes(task, node(task, Recover));
    const bool in_error = is_error(index_.task(task).current().task->state);
    const bool goes_with_process = in_error && node(task, Cleanup) == kNone && node(task, Recover) == kNone;
    if (is_killed(task) || goes_with_process) before_its_place_is_taken(task, undeploy_of(task));
  }

  /// The old incarnation is removed with its process, or when another task takes its placement.
  void before_it_vanishes(int task, int action) {
    add(action, undeploy_of(task));
    before_its_place_is_taken(task, action);
  }

  void before_its_place_is_taken(int task, int action) {
    if (is_in_place(task)) add(action, node(task, ActionKind::ApplyConfig));
    const int taker = takers_[as_index(task)];
    if (taker != kNone) add(action, node(taker, ActionKind::ApplyConfig));
  }

  /// Two incarnations of a task, or a task and the one whose state it continues, never run at the same time.
  void add_new(int task) {
    using enum ActionKind;
    chain(task, {ApplyConfig, Configure, HandOver, Start});
    const IndexedTask& entry = index_.task(task);
    add(nodes_.deploy[as_index(entry.target().process)], node(task, ApplyConfig));
    if (plan_.task(task).fate == TaskFate::Replaced && entry.current().process != entry.target().process) {
      if (entry.takes_over != task) add(halt(task), node(task, Start));
    }
  }

  /// The old task is stopped before its state is handed over, and exists until then.
  void add_take_over(int task) {
    using enum ActionKind;
    const int from = index_.task(task).takes_over;
    if (from == kNone) return;
    const int hand_over = node(task, HandOver);
    if (hand_over == kNone) {
      if (has_new(plan_.task(task).fate)) add(halt(from), node(task, Start));
      return;
    }
    add(node(from, Stop), hand_over);
    const int cleanup = node(from, Cleanup);
    add(hand_over, cleanup == kNone ? node(from, Start) : cleanup);
  }

  void add_old_connection(std::size_t number) {
    const int end = end_of_connection(number);
    if (end == kNone) return;
    const IndexedConnection& connection = index_.connections[kCurrent][number];
    before_its_end_goes(end, connection.from, connection.from_dynamic);
    before_its_end_goes(end, connection.to, connection.to_dynamic);
  }

  /// The action that removes a connection: its disconnect, or the end of a killed process.
  [[nodiscard]] int end_of_connection(std::size_t number) const {
    const IndexedConnection& connection = index_.connections[kCurrent][number];
    if (is_killed(connection.from)) return undeploy_of(connection.from);
    return is_killed(connection.to) ? undeploy_of(connection.to) : nodes_.disconnect[number];
  }

  [[nodiscard]] bool is_kept(int task) const { return plan_.task(task).fate == TaskFate::Kept; }

  void before_its_end_goes(int disconnect, int task, bool dynamic) {
    if (is_killed(task)) return;
    const int cleanup = node(task, ActionKind::Cleanup);
    if (is_kept(task)) {
      if (dynamic) add(disconnect, cleanup);
    } else if (cleanup != kNone) {
      add(disconnect, cleanup);
    } else {
      before_it_vanishes(task, disconnect);
    }
  }

  void add_connect(std::size_t number) {
    const int connect = nodes_.connect[number];
    if (connect == kNone) return;
    const IndexedConnection& connection = index_.connections[kTarget][number];
    after_its_end_comes(connect, connection.from, connection.from_dynamic);
    after_its_end_comes(connect, connection.to, connection.to_dynamic);
  }

  void after_its_end_comes(int connect, int task, bool dynamic) {
    if (dynamic) {
      add(node(task, ActionKind::Configure), connect);
    } else if (!is_kept(task)) {
      add(node(task, ActionKind::ApplyConfig), connect);
    }
    add(connect, node(task, ActionKind::Start));
  }

  void add_devices() {
    for (int task = 0; as_index(task) < index_.tasks.size(); ++task) {
      const IndexedTask& entry = index_.task(task);
      if (entry.current().task) for_each_device(kCurrent, task, [&](Device& d) { release(d, task); });
      if (entry.target().task) for_each_device(kTarget, task, [&](Device& d) { claim(d, task); });
    }
    for (Device& device : devices_)
      add_device(device);
  }

  template <class Action>
  void for_each_device(Side side, int task, const Action& action) {
    const TaskIncarnation& incarnation = index_.task(task).on[side];
    const model::Deployment* process = index_.process(incarnation.process).on[side];
    const model::HostName& host = process == nullptr ? model::kLocalHost : process->host;
    for (const std::string& name : incarnation.task->exclusive)
      action(device(host, name));
    if (incarnation.component.model == nullptr) return;
    for (const std::string& name : incarnation.component.model->exclusive)
      action(device(host, name));
  }

  Device& device(const model::HostName& host, const std::string& name) {
    const std::size_t number = devices_.size();
    const auto [found, is_new] = device_numbers_.emplace(device_key(host, name), number);
    if (is_new) devices_.emplace_back();
    return devices_[found->second];
  }

  /// A task in Fatal may hold its devices until its process has ended.
  void release(Device& device, int task) {
    const bool fatal = index_.task(task).current().task->state == TaskState::Fatal;
    const bool with_process = fatal || is_killed(task);
    const int action = with_process ? undeploy_of(task) : node(task, ActionKind::Cleanup);
    if (action != kNone) device.releases.push_back(action);
  }

  void claim(Device& device, int task) {
    const int action = node(task, ActionKind::Configure);
    if (action != kNone) device.claims.push_back(action);
  }

  /// Puts all releases before every claim, with a number of edges linear in both.
  void add_device(Device& device) {
    if (device.releases.empty() || device.claims.empty()) return;
    std::sort(device.releases.begin(), device.releases.end());
    const auto last = std::unique(device.releases.begin(), device.releases.end());
    for (auto release = device.releases.begin() + 1; release < last; ++release)
      add(*(release - 1), *release);
    for (const int claim : device.claims)
      add(*(last - 1), claim);
  }

  const Index& index_;
  const ChangeSet& plan_;
  const ActionNodes& nodes_;
  std::vector<int> takers_;  ///< per task: the task that takes its placement
  std::unordered_map<std::string, std::size_t> device_numbers_;
  std::vector<Device> devices_;
  Constraints found_;
};

}  // namespace

bool drop_impossible_hand_overs(ChangeSet& plan, const ActionNodes& nodes, const Constraints& constraints) {
  // Without hand-overs the constraints are acyclic, so every cycle contains one.
  const GroupedOrder found = sequence(static_cast<int>(nodes.list.size()), constraints.edges);
  std::vector<int> group_size(nodes.list.size());
  for (const int group : found.group_of)
    ++group_size[as_index(group)];
  bool dropped = false;
  plan.hands_over = false;
  for (std::size_t i = 0; i < nodes.list.size(); ++i) {
    if (nodes.list[i].kind != ActionKind::HandOver) continue;
    const bool possible = group_size[as_index(found.group_of[i])] == 1;
    if (!possible) plan.tasks[as_index(nodes.list[i].subject)].steps.remove(ActionKind::HandOver);
    dropped |= !possible;
    plan.hands_over |= possible;
  }
  return dropped;
}

Constraints find_constraints(const Index& index, const ChangeSet& plan, const ActionNodes& nodes) {
  return Finder(index, plan, nodes).find();
}

}  // namespace segue::solve::detail
