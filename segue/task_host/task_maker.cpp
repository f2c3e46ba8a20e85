// SPDX-License-Identifier: Apache-2.0
#include <segue/task_host/task_maker.hpp>

#include <algorithm>

namespace segue::task_host::detail {

namespace {

/// Used where neither the network nor the component specifies an activity.
void take_defaults(Activity& activity, const model::Deployment& deployment) {
  if (activity.scheduler == Scheduler::Normal && activity.priority == 0) {
    activity.scheduler = deployment.scheduler;
    activity.priority = deployment.priority;
  }
  if (activity.cpus.empty()) {
    activity.cpus = deployment.cpus;
  }
}

/// A stand-in has no descriptor to wait for.
void follow_clock(Activity& activity, const Activity& component_default) {
  if (activity.trigger != Trigger::FileDescriptorDriven) {
    return;
  }
  activity.trigger = component_default.trigger;
  activity.period = component_default.period;
  activity.triggers.clear();
}

std::vector<std::string> property_names(const model::Task& definition) {
  std::vector<std::string> names;
  if (definition.properties.is_map()) {
    for (const auto& [name, value] : definition.properties.as_map()) {
      names.push_back(name);
    }
  }
  return names;
}

}  // namespace

Result<void> TaskMaker::can_make(const model::ComponentName& component) const {
  if (stands_in(component) || libraries_.has(component)) {
    return {};
  }
  if (auto made = libraries_.create(component); !made) {
    return std::move(made.error());
  }
  return {};
}

void TaskMaker::expect(const model::Network& network) {
  auto ports = expected_ports(network);
  const Lock lock(mutex_);
  for (auto& [task, named] : ports) {
    auto& known = expected_[task];
    for (auto& port : named) {
      if (std::find(known.begin(), known.end(), port) == known.end()) {
        known.push_back(std::move(port));
      }
    }
  }
}

bool TaskMaker::stands_in(const model::ComponentName& component) const {
  const auto& real = options_.never_stand_ins;
  if (std::find(real.begin(), real.end(), component) != real.end()) {
    return false;
  }
  return options_.only_stand_ins || (options_.stand_in && !libraries_.has(component));
}

bool TaskMaker::is_unchecked(const model::ComponentName& component) const {
  const bool makes_any = options_.stand_in || options_.only_stand_ins;
  return stands_in(component) || (makes_any && catalog_.find(component) == nullptr);
}

std::optional<std::string> TaskMaker::problem_of_behaviour(const model::Task& definition) const {
  const type::Value* own = definition.properties.find(kStandInProperty);
  if (own == nullptr || !stands_in(definition.component)) {
    return std::nullopt;
  }
  auto behaviour = read_behaviour(*own, {}, kStandInProperty);
  return behaviour ? std::nullopt : std::optional(std::move(behaviour.error().message));
}

StandInBehaviour TaskMaker::behaviour_of(const model::Task& definition) const {
  StandInBehaviour base = options_.stand_ins.of(definition.component, definition.id);
  const type::Value* own = definition.properties.find(kStandInProperty);
  if (own == nullptr) {
    return base;
  }
  return read_behaviour(*own, base, kStandInProperty).value_or(base);
}

std::unique_ptr<task::Component> TaskMaker::make_stand_in_for(const model::Task& definition) const {
  StandInPlan plan;
  plan.component = definition.component;
  plan.model = catalog_.find(definition.component);
  plan.types = &catalog_.types();
  plan.properties = property_names(definition);
  plan.behaviour = options_.stand_ins.of(definition.component, definition.id);
  {
    const Lock lock(mutex_);
    if (const auto found = expected_.find(definition.id); found != expected_.end()) {
      plan.ports = found->second;
    }
  }
  return make_stand_in(plan);
}

Result<std::unique_ptr<task::Component>> TaskMaker::make_component(const model::Task& definition,
                                                                   bool stand_in) const {
  if (stand_in) {
    return make_stand_in_for(definition);
  }
  return libraries_.create(definition.component);
}

Activity TaskMaker::activity_for(const model::Task& definition, const ProcessEntry* process,
                                 const task::Component& component, bool stand_in) const {
  const Activity of_component =
      stand_in ? stand_in_activity(catalog_.find(definition.component), behaviour_of(definition))
               : component.options().activity;
  Activity activity = definition.activity.value_or(of_component);
  if (stand_in) {
    follow_clock(activity, of_component);
  }
  if (process != nullptr) {
    take_defaults(activity, process->deployment);
  }
  return activity;
}

Result<std::shared_ptr<task::Executor>> TaskMaker::executor_for(const model::TaskId& task,
                                                                const Activity& activity,
                                                                const ProcessEntry* process) {
  task::ExecutorSet& executors = process == nullptr ? task::ExecutorSet::of_process() : *process->executors;
  return executors.executor_for(task.str(), activity);
}

Result<std::shared_ptr<task::Task>> TaskMaker::renew(const TaskEntry& entry, const Activity& activity,
                                                     const ProcessEntry* process, TimePoint deadline) const {
  auto executor = executor_for(entry.definition.id, activity, process);
  if (!executor) {
    return std::move(executor.error());
  }
  auto task = task::Task::renew(*entry.task, activity, std::move(*executor), deadline);
  if (!task) {
    return std::move(task.error());
  }
  return std::shared_ptr<task::Task>(std::move(*task));
}

Result<void> TaskMaker::complete(const TaskEntry& entry, const model::Task& definition, TimePoint deadline) {
  const auto missing = missing_properties(entry.task->component(), property_names(definition));
  if (!entry.stand_in || missing.empty()) {
    return {};
  }
  const TimedWriteLock shape(*entry.ports, deadline);
  if (!shape) {
    return busy(entry);
  }
  return entry.task->extend([&](task::Component& component) { add_properties(component, missing); },
                            deadline);
}

Result<TaskEntry> TaskMaker::make(const model::Task& definition, const ProcessEntry* process) const {
  const bool stand_in = stands_in(definition.component);
  auto component = make_component(definition, stand_in);
  if (!component) {
    return std::move(component.error());
  }
  const Activity activity = activity_for(definition, process, **component, stand_in);
  auto executor = executor_for(definition.id, activity, process);
  if (!executor) {
    return std::move(executor.error());
  }
  auto task = task::Task::create(definition.id.str(), std::move(*component), activity, std::move(*executor));
  if (!task) {
    return std::move(task.error());
  }
  TaskEntry entry;
  entry.task = std::move(*task);
  entry.ports = std::make_shared<PortsMutex>();
  entry.definition = definition;
  entry.stand_in = stand_in;
  return entry;
}

}  // namespace segue::task_host::detail
