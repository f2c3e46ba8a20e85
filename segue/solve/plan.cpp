// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/solve/component_facts.hpp>
#include <segue/solve/placement_index.hpp>
#include <segue/solve/plan.hpp>

#include <algorithm>

namespace segue::solve::detail {

namespace {

using model::ActionKind;

/// The steps from a state down to pre-operational.
Steps steps_down(TaskState now) {
  switch (now) {
    case TaskState::Running:
    case TaskState::RunTimeError:
      return {ActionKind::Stop, ActionKind::Cleanup};
    case TaskState::Stopped:
      return {ActionKind::Cleanup};
    case TaskState::Exception:
      return {ActionKind::Recover};
    case TaskState::PreOperational:
    case TaskState::Fatal:
      break;
  }
  return {};
}

/// The steps from pre-operational up to a state.
Steps steps_up(TaskState target) {
  if (target == TaskState::Running) return {ActionKind::Configure, ActionKind::Start};
  if (target == TaskState::Stopped) return {ActionKind::Configure};
  return {};
}

/// The steps between two states without reconfiguration.
Steps steps_between(TaskState now, TaskState target) {
  if (now == target) return {};
  if (!is_configured(now) || !is_configured(target)) return steps_down(now) + steps_up(target);
  if (target == TaskState::Stopped) return {ActionKind::Stop};
  return now == TaskState::RunTimeError ? Steps{ActionKind::Recover} : Steps{ActionKind::Start};
}

/// The steps that remove the old incarnation. A task in Exception needs no recovery if its process is
/// removed.
Steps steps_of_old(TaskState now, bool process_stays) {
  if (now == TaskState::Exception && !process_stays) return {};
  return steps_down(now);
}

Steps steps_of_new(TaskState target) {
  return Steps{ActionKind::ApplyConfig} + steps_up(target);
}

class Planner {
 public:
  Planner(const Index& index, const Options& options) : index_(index) { plan_.options = options; }

  Result<ChangeSet> plan() {
    plan_processes();
    if (auto done = redeploy_fatal(); !done) return done.error();
    redeploy_full_processes();
    plan_.tasks.reserve(index_.tasks.size());
    for (const IndexedTask& task : index_.tasks) {
      plan_.tasks.push_back(plan_task(task));
      if (auto done = check_lasting_error(task); !done) return done.error();
    }
    if (plan_.options.order != model::Order::Paper) plan_hand_overs();
    plan_connection();
    return std::move(plan_);
  }

 private:
  void plan_processes() {
    plan_.processes.reserve(index_.processes.size());
    for (const IndexedProcess& process : index_.processes)
      plan_.processes.push_back(fate_of(process));
  }

  static ProcessFate fate_of(const IndexedProcess& process) {
    const model::Deployment* now = process.current();
    const model::Deployment* then = process.target();
    if (now == nullptr) return then == nullptr ? ProcessFate::Kept : ProcessFate::Deployed;
    if (then == nullptr) return ProcessFate::Undeployed;
    return now->same_process(*then) ? ProcessFate::Kept : ProcessFate::Redeployed;
  }

  void redeploy(int process) {
    ProcessFate& fate = plan_.processes[as_index(process)];
    if (fate == ProcessFate::Kept) fate = ProcessFate::Redeployed;
  }

  /// No action leads out of Fatal: the process has to be replaced or removed. Nobody can do that with the
  /// runtime's own, so a task there can only be dropped.
  Result<> redeploy_fatal() {
    for (std::size_t i = 0; i < index_.current_tasks; ++i) {
      const TaskIncarnation& task = index_.tasks[i].current();
      if (task.task->state != TaskState::Fatal || stays_fatal(index_.tasks[i])) continue;
      if (task.process == kRuntime) {
        if (can_be_dropped(index_.tasks[i])) continue;
        return fail(
            ErrorCode::Unsupported,
            "task " + quote(task.task->id.str()) + " is in a fatal error inside the runtime's own " +
                "process, which no transition can restart; restart the runtime, and give the task a " +
                "deployment of its own",
            task.task->id.str(), task.task->where);
      }
      redeploy(task.process);
    }
    return {};
  }

  /// Whether the target neither has the task nor needs a device that it may hold for ever.
  [[nodiscard]] bool can_be_dropped(const IndexedTask& entry) const {
    if (entry.target().task != nullptr) return false;
    const auto held = devices_of(entry, kCurrent);
    if (held.empty()) return true;
    return std::ranges::none_of(index_.target_order, [&](int number) {
      const auto wanted = devices_of(index_.task(number), kTarget);
      return std::ranges::find_first_of(held, wanted) != held.end();
    });
  }
  [[nodiscard]] std::vector<std::string> devices_of(const IndexedTask& entry, Side side) const {
    const TaskIncarnation& task = entry.on[side];
    const model::Deployment* process = index_.process(task.process).on[side];
    const auto key = process == nullptr ? model::DeploymentKey{} : process->key();
    return exclusive_devices(*task.task, task.component, key);
  }

  static bool stays_fatal(const IndexedTask& entry) {
    return entry.target().task != nullptr && entry.target().task->state == TaskState::Fatal;
  }

  /// A task whose error is to stay must not have any steps. Checked last.
  [[nodiscard]] Result<> check_lasting_error(const IndexedTask& entry) const {
    if (entry.target().task == nullptr || !is_error(entry.target().task->state)) return {};
    const TaskPlan& plan = plan_.tasks.back();
    if (plan.fate == TaskFate::Kept && plan.steps.empty()) return {};
    const model::Task& task = *entry.target().task;
    return fail(ErrorCode::Unsupported,
                "task " + quote(task.id.str()) + " is to stay in state " +
                    std::string(to_string(task.state)) +
                    ", but has to be created or configured again; ask for another state of it",
                task.id.str(), task.where);
  }

  /// A process that another deployer starts holds the tasks it was built with: another component under a name
  /// that it has needs a new process.
  void redeploy_full_processes() {
    if (index_.tasks_renamed) {
      redeploy_by_place();
      return;
    }
    for (const IndexedTask& task : index_.tasks) {
      if (task.in_both()) redeploy_if_other(task.current(), task.target());
    }
  }

  void redeploy_by_place() {
    const OccupantIndex occupants(index_, kCurrent);
    for (const int number : index_.target_order) {
      const TaskIncarnation& task = index_.task(number).target();
      const int occupant = occupants.find(task.process, task.name);
      if (occupant != kNone) redeploy_if_other(index_.task(occupant).current(), task);
    }
  }

  void redeploy_if_other(const TaskIncarnation& now, const TaskIncarnation& then) {
    if (now.process != then.process || now.process == kRuntime) return;
    if (now.task->component == then.task->component) return;
    const model::Deployment* deployment = index_.process(now.process).current();
    if (!holds_any_component(*deployment)) redeploy(now.process);
  }

  [[nodiscard]] TaskPlan plan_task(const IndexedTask& entry) const {
    if (entry.target().task == nullptr) return {TaskFate::Removed, false, old_steps(entry)};
    const TaskState target = entry.target().task->state;
    if (entry.current().task == nullptr) return {TaskFate::Added, false, steps_of_new(target)};
    if (!is_same_incarnation(entry)) {
      return {TaskFate::Replaced, false, old_steps(entry) + steps_of_new(target)};
    }
    const model::Task& now = *entry.current().task;
    const model::Task& then = *entry.target().task;
    if (now.same_configuration(then)) return {TaskFate::Kept, false, steps_between(now.state, target)};
    if (can_apply_live(entry)) {
      return {TaskFate::Kept, true, steps_between(now.state, target) + Steps{ActionKind::ApplyConfig}};
    }
    return {TaskFate::Kept, false, steps_down(now.state) + steps_of_new(target)};
  }

  static bool can_apply_live(const IndexedTask& entry) {
    return is_configured(entry.current()) && is_configured(entry.target()) &&
           differ_only_live(*entry.current().task, *entry.target().task, entry.target().component.model);
  }

  [[nodiscard]] Steps old_steps(const IndexedTask& entry) const {
    if (plan_.is_killed(entry.current().process)) return {};
    const bool stays = !is_undeployed(plan_.process(entry.current().process));
    return steps_of_old(entry.current().task->state, stays);
  }

  [[nodiscard]] bool is_same_incarnation(const IndexedTask& entry) const {
    const TaskIncarnation& now = entry.current();
    const TaskIncarnation& then = entry.target();
    return now.process == then.process && !is_undeployed(plan_.process(now.process)) &&
           (entry.prepared || now.name == then.name) && now.task->component == then.task->component;
  }

  void plan_hand_overs() {
    for (const int number : index_.target_order) {
      if (!can_hand_over(number)) continue;
      plan_.tasks[as_index(number)].steps.add(ActionKind::HandOver);
      plan_.hands_over = true;
    }
  }

  /// Whether a hand-over is possible: from a task that can be found stopped to one that starts, or is at
  /// least ready when the other's state is lost. In place nothing is handed over: the old incarnation is
  /// cleaned up before the new one is there.
  [[nodiscard]] bool can_hand_over(int to) const {
    const int from = index_.task(to).takes_over;
    if (from == kNone || index_.task(from).current().task == nullptr) return false;
    const Steps steps = plan_.task(to).steps;
    const bool is_last_chance =
        steps.has(ActionKind::Configure) && plan_.task(from).steps.has(ActionKind::Cleanup);
    const bool begins = steps.has(ActionKind::Start) || is_last_chance;
    if (!begins || is_killed(from)) return false;
    if (from == to && plan_.task(to).fate != TaskFate::Replaced) return false;
    const TaskState state = index_.task(from).current().task->state;
    return state == TaskState::Stopped ||
           (segue::is_configured(state) && plan_.task(from).steps.has(ActionKind::Stop));
  }

  void plan_connection() {
    const std::vector<IndexedConnection>& current = index_.connections[kCurrent];
    const std::vector<IndexedConnection>& target = index_.connections[kTarget];
    plan_.disconnect.resize(current.size());
    plan_.connect.assign(target.size(), true);
    for (std::size_t i = 0; i < current.size(); ++i) {
      const IndexedConnection& connection = current[i];
      if (!exists(index_, connection)) continue;
      const bool kept = stays(connection);
      plan_.disconnect[i] = !kept && !is_killed(connection.from) && !is_killed(connection.to);
      if (kept) plan_.connect[as_index(connection.partner)] = false;
    }
  }

  [[nodiscard]] bool stays(const IndexedConnection& connection) const {
    if (connection.partner == kNone) return false;
    const IndexedConnection& partner = index_.connections[kTarget][as_index(connection.partner)];
    return connection.connection->policy == partner.connection->policy &&
           keeps(connection.from, connection.from_dynamic) && keeps(connection.to, connection.to_dynamic);
  }

  /// Whether the task and its connections end with its process.
  [[nodiscard]] bool is_killed(int number) const {
    return plan_.is_killed(index_.task(number).current().process);
  }

  /// Whether the port at this end outlives the transition.
  [[nodiscard]] bool keeps(int number, bool dynamic) const {
    const TaskPlan& plan = plan_.task(number);
    return plan.fate == TaskFate::Kept && !(dynamic && plan.steps.has(ActionKind::Cleanup));
  }

  const Index& index_;
  ChangeSet plan_;
};

}  // namespace

bool exists(const Index& index, const IndexedConnection& connection) {
  return !(connection.from_dynamic && !is_configured(index.task(connection.from).current())) &&
         !(connection.to_dynamic && !is_configured(index.task(connection.to).current()));
}

bool holds_any_component(const model::Deployment& deployment) {
  return deployment.deployer == "segue";
}

Result<ChangeSet> make_plan(const Index& index, const Options& options) {
  return Planner(index, options).plan();
}

}  // namespace segue::solve::detail
