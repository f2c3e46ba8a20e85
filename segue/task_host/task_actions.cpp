// SPDX-License-Identifier: Apache-2.0
#include <segue/task_host/task_actions.hpp>

#include <segue/base/text.hpp>

#include <algorithm>
#include <atomic>

namespace segue::task_host::detail {

namespace {

using model::ActionKind;

/// A call that waits for the task's thread ends at its deadline by itself; only an operation in the caller's
/// thread can exceed it.
constexpr Duration kCallGrace = std::chrono::seconds(1);

/// The task on which this thread carries out an action: changes of its state are not reported as events.
thread_local const task::Task* acting_on = nullptr;

class Acting {
 public:
  explicit Acting(const task::Task& task) : before_(std::exchange(acting_on, &task)) {}
  Acting(const Acting&) = delete;
  Acting& operator=(const Acting&) = delete;
  ~Acting() { acting_on = before_; }

 private:
  const task::Task* before_;
};

std::string state_text(const TaskEntry& entry) {
  return quote(to_string(entry.state()));
}

/// Assigns a new value: the fields of a compound one by one, other values as a whole.
void change(type::Value& present, const type::Value& value, const task::PropertyBase* property) {
  if (property != nullptr && property->takes_parts()) {
    type::merge(present, value);
  } else {
    present = value;
  }
}

/// The values to set so that properties change from `before` to `wanted`; a property that is not named has
/// its default. Unchanged ones are left out, since most properties can only be set in PreOperational.
type::Value values_for(const task::Component& component, const type::Value& wanted,
                       const type::Value& before) {
  type::ValueMap values;
  for (const task::PropertyBase* property : component.properties()) {
    const type::Value* next = wanted.find(property->name());
    const type::Value* last = before.find(property->name());
    const bool same = (next == nullptr) == (last == nullptr) && (next == nullptr || *next == *last);
    if (same) {
      continue;
    }
    type::Value value = property->default_value();
    if (next != nullptr) {
      change(value, *next, property);
    }
    values.set(property->name(), std::move(value));
  }
  // Unknown properties too: the task reports them, with the names that exist.
  for (const auto& [name, value] : wanted.as_map()) {
    if (component.find_property(name) == nullptr) {
      values.set(name, value);
    }
  }
  return values;
}

/// "range.max" and 30 as {range: {max: 30}}. A property whose own name has dots is taken as it is. One that
/// is replaced as a whole keeps the rest of its map.
type::Value nested(const task::Task& task, std::string_view path, type::Value value) {
  std::string_view rest = path;
  const task::PropertyBase* property = task.component().find_property(rest);
  while (property == nullptr) {
    const std::size_t dot = rest.rfind('.');
    if (dot == std::string_view::npos) {
      break;
    }
    value = type::Value::map({{std::string(rest.substr(dot + 1)), std::move(value)}});
    rest = rest.substr(0, dot);
    property = task.component().find_property(rest);
  }
  if (property != nullptr && rest != path && !property->takes_parts()) {
    const type::Value all = task.properties();
    type::Value whole = *all.find(rest);
    type::merge(whole, value);
    value = std::move(whole);
  }
  return type::Value::map({{std::string(rest), std::move(value)}});
}

/// Updates the properties of the task's definition after `values` were set.
void note(type::Value& properties, const type::Value& values, const task::Component& component) {
  for (const auto& [name, value] : values.as_map()) {
    const type::Value* known = properties.find(name);
    type::Value next = known == nullptr ? type::Value{} : *known;
    change(next, value, component.find_property(name));
    properties.as_map().set(name, std::move(next));
  }
}

}  // namespace

Result<void> TaskActions::perform(const model::Action& action, TimePoint deadline) {
  struct Visitor {
    TaskActions& self;
    ActionKind kind;
    bool at_commit;  ///< what Prepare connects begins with the commit
    TimePoint deadline;
    Result<void> operator()(const model::TaskAction& what) const {
      return self.perform_on_task(kind, what.task, deadline);
    }
    Result<void> operator()(const model::ConnectionAction& what) const {
      return kind == ActionKind::Connect ? self.connections_.connect(what.connection, at_commit, deadline)
                                         : self.connections_.disconnect(what.connection, deadline);
    }
    Result<void> operator()(const model::DeploymentAction& what) const {
      return kind == ActionKind::Deploy ? self.deploy(what.deployment)
                                        : self.undeploy(what.deployment.key(), what.kill);
    }
    Result<void> operator()(const model::ConfigAction& what) const {
      return self.apply_config(what, deadline);
    }
    Result<void> operator()(const model::HandOverAction& what) const {
      return self.hand_over(what, deadline);
    }
    Result<void> operator()(const model::CallAction& what) const {
      auto answer = self.call(what.task, what.operation, what.arguments, deadline);
      return answer ? Result<void>{} : Result<void>(std::move(answer.error()));
    }
  };
  return std::visit(Visitor{*this, action.kind, action.phase == model::Phase::Prepare, deadline},
                    action.what);
}

Result<void> TaskActions::perform_on_task(ActionKind kind, const model::TaskId& id, TimePoint deadline) {
  auto entry = table_.find(id);
  if (!entry) {
    return std::move(entry.error());
  }
  if (kind == ActionKind::Configure) {
    if (auto free = check_devices(*entry); !free) {
      return free;
    }
  }
  const VerbWatch::Verb verb(verbs_, id, entry->task.get(), to_string(kind), deadline);
  auto done = run_verb(kind, *entry, deadline);
  if (!done && done.error().code == ErrorCode::DeadlineExceeded) {
    verbs_.blocked(id, entry->task);
  }
  return done;
}

Result<void> TaskActions::run_verb(ActionKind kind, const TaskEntry& entry, TimePoint deadline) {
  task::Task& task = *entry.task;
  const Acting acting(task);
  if (kind == ActionKind::Start) {
    return task.start(deadline);
  }
  if (kind == ActionKind::Stop) {
    return task.stop(deadline);
  }
  // The other verbs create and remove ports.
  const TimedWriteLock ports(*entry.ports, deadline);
  if (!ports) {
    return busy(entry);
  }
  auto done = kind == ActionKind::Configure ? task.configure(deadline)
              : kind == ActionKind::Cleanup ? task.cleanup(deadline)
                                            : task.recover(deadline);
  table_.drop_ended_connections_of(entry.definition.id);
  return done;
}

Result<type::Value> TaskActions::call(const model::TaskId& id, std::string_view operation,
                                      const type::Value& arguments, TimePoint deadline) {
  auto entry = table_.find(id);
  if (!entry) {
    return std::move(entry.error());
  }
  const TimePoint overdue = deadline < TimePoint::max() - kCallGrace ? deadline + kCallGrace : deadline;
  const VerbWatch::Verb calling(verbs_, id, entry->task.get(), operation, overdue);
  return entry->task->call(operation, arguments, deadline);
}

std::map<model::TaskId, std::string> TaskActions::hanging() {
  std::map<model::TaskId, std::string> hanging;
  for (auto& late : verbs_.overdue()) {
    const auto entry = table_.look_up(late.id);
    // One that was removed meanwhile hangs on, but the task that has its id now does not.
    if ((entry ? entry->task.get() : nullptr) == late.task) {
      hanging.emplace(std::move(late.id), std::move(late.why));
    }
  }
  for (const TaskEntry& entry : table_.all()) {
    if (auto overdue = entry.task->overdue()) {
      hanging.insert_or_assign(entry.definition.id, std::move(*overdue));
    }
  }
  return hanging;
}

Result<std::optional<task::SavedState>> TaskActions::save_state(const model::TaskId& id, TimePoint deadline) {
  auto entry = table_.find(id);
  if (!entry) {
    return std::move(entry.error());
  }
  const VerbWatch::Verb saving(verbs_, id, entry->task.get(), "save_state", deadline);
  return entry->task->save_state(deadline);
}

Result<void> TaskActions::restore_state(const model::TaskId& id, const task::SavedState& state,
                                        TimePoint deadline) {
  auto entry = table_.find(id);
  if (!entry) {
    return std::move(entry.error());
  }
  const VerbWatch::Verb restoring(verbs_, id, entry->task.get(), "restore_state", deadline);
  const Acting acting(*entry->task);
  // A component in which restoring fails is cleaned up, which removes its ports.
  const TimedWriteLock ports(*entry->ports, deadline);
  if (!ports) {
    return busy(*entry);
  }
  auto done = entry->task->restore_state(state, deadline);
  table_.drop_ended_connections_of(id);
  return done;
}

Result<void> TaskActions::hand_over(const model::HandOverAction& what, TimePoint deadline) {
  if (auto to = table_.find(what.to); !to) {
    return std::move(to.error());
  }
  const auto state = save_state(what.from, deadline);
  if (!state) {
    return state.error();
  }
  return state->has_value() ? restore_state(what.to, **state, deadline) : Result<void>();
}

Result<void> TaskActions::check_devices(const TaskEntry& entry) const {
  const auto devices_of = [](const TaskEntry& of) {
    std::vector<std::string> devices = of.definition.exclusive;
    const auto& claimed = of.task->component().options().claims;
    devices.insert(devices.end(), claimed.begin(), claimed.end());
    return devices;
  };
  const auto wanted = devices_of(entry);
  if (wanted.empty()) {
    return {};
  }
  for (const TaskEntry& other : table_.all()) {
    if (other.task == entry.task || !other.configured()) {
      continue;
    }
    for (const auto& device : devices_of(other)) {
      if (std::find(wanted.begin(), wanted.end(), device) != wanted.end()) {
        return fail(ErrorCode::InvalidState, "device " + quote(device) + " is held by task " +
                                                 quote(other.definition.id.str()) + "; clean it up first");
      }
    }
  }
  return {};
}

Result<void> TaskActions::deploy(const model::Deployment& deployment) {
  if (deployment.key().is_runtime()) {
    return fail(ErrorCode::InvalidArgument, "a process needs a name; the runtime's own is always there");
  }
  return table_.add_process(deployment);
}

Result<void> TaskActions::undeploy(const model::DeploymentKey& key, bool kill) {
  if (!table_.find_process(key)) {
    return fail(ErrorCode::NotFound, "process " + quote(to_string(key)) + " is not deployed");
  }
  const auto tasks = table_.in_process(key);
  const auto hangs = hanging();
  for (const TaskEntry& entry : tasks) {
    if (entry.configured() && !kill && !hangs.contains(entry.definition.id)) {
      return fail(ErrorCode::InvalidState, "task " + quote(entry.definition.id.str()) + " in process " +
                                               quote(to_string(key)) + " is still " + state_text(entry) +
                                               "; stop it and clean it up first");
    }
  }
  for (auto& task : table_.take_process(key)) {
    abandoned_.destroy(std::move(task));
  }
  return {};
}

Result<void> TaskActions::apply_config(const model::ConfigAction& action, TimePoint deadline) {
  std::optional<ProcessEntry> process;
  if (!action.process.is_runtime()) {
    process = table_.find_process(action.process);
    if (!process) {
      return fail(ErrorCode::InvalidState,
                  "process " + quote(to_string(action.process)) + " is not deployed; deploy it first");
    }
  }
  if (!action.definition.properties.is_map()) {
    return fail(ErrorCode::InvalidArgument,
                "properties: expected a map, got " + type::describe(action.definition.properties));
  }
  const ProcessEntry* place = process ? &*process : nullptr;
  auto entry = table_.look_up(action.definition.id);
  const task::Task* const present = entry ? entry->task.get() : nullptr;
  const VerbWatch::Verb verb(verbs_, action.definition.id, present, "applying the configuration", deadline);
  if (!entry) {
    return create(action, place, deadline);
  }
  const bool stays =
      entry->definition.component == action.definition.component && entry->process == action.process;
  if (stays) {
    return reapply(std::move(*entry), action, place, deadline);
  }
  if (entry->configured()) {
    return fail(ErrorCode::InvalidState, "is still " + state_text(*entry) + " as " +
                                             quote(entry->definition.component.str()) + " in " +
                                             quote(to_string(entry->process)) + "; clean it up first");
  }
  table_.take_connections_of(action.definition.id);
  return create(action, place, deadline);
}

Result<void> TaskActions::create(const model::ConfigAction& action, const ProcessEntry* process,
                                 TimePoint deadline) {
  auto entry = maker_.make(action.definition, process);
  if (!entry) {
    return std::move(entry.error());
  }
  entry->process = action.process;
  entry->name = action.name;
  const type::Value values =
      values_for(entry->task->component(), action.definition.properties, type::ValueMap{});
  if (auto set = entry->task->set_properties(values, deadline); !set) {
    return set;
  }
  listen_to(*entry);
  auto replaced = table_.put(std::move(*entry));
  if (!replaced) {
    return std::move(replaced.error());
  }
  abandoned_.destroy(std::move(*replaced));
  return {};
}

Result<void> TaskActions::reapply(TaskEntry entry, const model::ConfigAction& action,
                                  const ProcessEntry* process, TimePoint deadline) {
  const TaskState state = entry.state();
  if (state == TaskState::Exception || state == TaskState::Fatal) {
    return fail(ErrorCode::InvalidState, "is in " + state_text(entry) + "; recover it first");
  }
  const model::Task& wanted = action.definition;
  const Activity activity = maker_.activity_for(wanted, process, entry.task->component(), entry.stand_in);
  if (activity != entry.task->activity()) {
    if (auto renewed = renew(entry, activity, process, deadline); !renewed) {
      return renewed;
    }
  }
  if (state == TaskState::PreOperational) {
    if (auto completed = TaskMaker::complete(entry, wanted, deadline); !completed) {
      return completed;
    }
  }
  const auto shape = hold_ports(entry, deadline);
  if (!shape) {
    return shape.error();
  }
  const type::Value values =
      values_for(entry.task->component(), wanted.properties, entry.definition.properties);
  if (!values.as_map().empty()) {
    if (auto set = entry.task->set_properties(values, deadline); !set) {
      return set;
    }
  }
  entry.definition = wanted;
  entry.name = action.name;
  return table_.update(entry.task.get(), entry);  // a copy, since `shape` is a lock of its mutex
}

Result<void> TaskActions::renew(TaskEntry& entry, const Activity& activity, const ProcessEntry* process,
                                TimePoint deadline) {
  if (entry.state() != TaskState::PreOperational) {
    return fail(ErrorCode::InvalidState,
                "its activity can only change in 'pre_operational', and it is " + state_text(entry));
  }
  auto task = maker_.renew(entry, activity, process, deadline);
  if (!task) {
    return std::move(task.error());
  }
  const auto present = std::exchange(entry.task, std::move(*task));
  listen_to(entry);
  return table_.update(present.get(), entry);
}

void TaskActions::conclude(const model::Transition& transition) {
  const auto hangs = hanging();
  for (const auto& id : transition.removes) {
    const auto entry = table_.look_up(id);
    // A task that hangs in a process of its own ends with that process.
    const bool dropped = entry && entry->process.is_runtime() && hangs.contains(id);
    if (entry && (!entry->configured() || dropped)) {
      table_.take_connections_of(id);
      abandoned_.destroy(table_.take(id));
    }
  }
  for (const auto& task : transition.redefines) {
    table_.redefine(task.id, [&](model::Task& definition) { definition = task; });
  }
}

Result<void> TaskActions::set_property(const model::TaskId& id, std::string_view path,
                                       const type::Value& value, TimePoint deadline) {
  auto entry = table_.find(id);
  if (!entry) {
    return std::move(entry.error());
  }
  const auto shape = hold_ports(*entry, deadline);
  if (!shape) {
    return shape.error();
  }
  const type::Value values = nested(*entry->task, path, value);
  if (auto set = entry->task->set_properties(values, deadline); !set) {
    return set;
  }
  table_.redefine(
      id, [&](model::Task& definition) { note(definition.properties, values, entry->task->component()); });
  return {};
}

/// The listener runs in updates too: it is real-time safe.
void TaskActions::listen_to(const TaskEntry& entry) {
  const auto source = std::make_shared<TaskEvents::Source>(entry.definition.id, entry.task);
  auto last = std::make_shared<std::atomic<TaskState>>(entry.state());
  entry.task->set_state_listener([this, source, last](const task::Task& task, TaskState state) {
    const bool changed = last->exchange(state) != state;
    if (changed && acting_on != &task) {
      events_.note(source, state);
    }
    watches_.ring();
  });
}

}  // namespace segue::task_host::detail
