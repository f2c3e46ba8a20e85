// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/task/executor_set.hpp>
#include <segue/task/realtime_log.hpp>
#include <segue/task/task.hpp>
#include <segue/task/task_implementation.hpp>

#include <algorithm>
#include <cassert>

namespace segue::task {

namespace {

Result<void> check_activity(const std::string& id, const Activity& activity) {
  if (activity.trigger != Trigger::Periodic || activity.period > Duration::zero()) return {};
  return fail(ErrorCode::InvalidArgument,
              "a periodic task needs a period above zero, not " + format_duration(activity.period), id);
}

template <class Named>
Result<void> check_unique(const std::vector<Named*>& all, std::string_view kind, const std::string& id) {
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (all[i]->name() != all[j]->name()) continue;
      return fail(ErrorCode::AlreadyExists,
                  "the component has two " + std::string(kind) + " named " + quote(all[i]->name()), id);
    }
  }
  return {};
}

Result<void> check_names(const Component& component, const std::string& id) {
  if (auto unique = check_unique(component.inputs(), "input ports", id); !unique) return unique;
  if (auto unique = check_unique(component.outputs(), "output ports", id); !unique) return unique;
  if (auto unique = check_unique(component.properties(), "properties", id); !unique) return unique;
  return check_unique(component.operations(), "operations", id);
}

template <class Named>
std::vector<std::string> names_of(const std::vector<Named*>& all) {
  std::vector<std::string> names;
  for (const Named* one : all)
    names.push_back(one->name());
  return names;
}

}  // namespace

Task::Implementation::Implementation(std::string task_id, std::unique_ptr<Component> made, Activity wanted,
                                     std::shared_ptr<Executor> runner)
    : executor(std::move(runner)),
      component(std::move(made)),
      activity(std::move(wanted)),
      update_deadline(deadline_of(activity)),
      name(std::move(task_id)),
      properties_mutex(std::make_shared<Mutex>()) {
  RealtimeLog::instance();
  ComponentAccess::set_context(*component, this);
}

Task::Implementation::Implementation(const Implementation& old, Activity wanted,
                                     std::shared_ptr<Executor> runner)
    : executor(std::move(runner)),
      component(old.component),
      activity(std::move(wanted)),
      update_deadline(deadline_of(activity)),
      name(old.name),
      properties_mutex(old.properties_mutex) {
  ComponentAccess::set_context(*component, this);
}

Task::Implementation::~Implementation() {
  assert(!ownership.is_mine() && "a task must not be destroyed by its own hook");
  static_cast<void>(exclusive("destroy", detail::kNever, [this]() -> Result<void> {
    shut_down();
    listener = nullptr;
    return {};
  }));
  if (!retired) {
    for (InputPortBase* input : component->inputs())
      input->disconnect_all();
    for (OutputPortBase* output : component->outputs())
      output->disconnect_all();
  }
  executor->remove(*this);
  calls.take_all([](detail::PendingCall& call) { call.cancel(); });
  if (!retired) ComponentAccess::set_context(*component, nullptr);
}

TimePoint Task::Implementation::patience(TimePoint deadline) const {
  const TimePoint overdue_at = progress.overdue_at();
  if (deadline == detail::kNever || overdue_at == detail::kNever) return deadline;
  const TimePoint now = RealClock::instance().now();
  const Duration left = overdue_at - executor->clock().now();
  return left < deadline - now ? now + left : deadline;
}

Error Task::Implementation::too_late(std::string_view verb) const {
  return fail(
      ErrorCode::DeadlineExceeded,
      "cannot " + std::string(verb) + " now: " + overdue().value_or("an update or a hook runs too long"),
      name);
}

std::optional<std::string> Task::Implementation::overdue() const {
  const auto what = progress.overdue(executor->clock().now());
  if (!what) return std::nullopt;
  return std::string(*what) + " has not returned within " + format_duration(update_deadline);
}

std::string Task::Implementation::state_name() const {
  const std::uint32_t word = state_word.load(std::memory_order_acquire);  // pairs with V1
  const auto plain = static_cast<TaskState>(word & 0xFFU);
  const std::uint32_t sub_state = word >> 8U;
  if (sub_state == 0) return std::string(to_string(plain));
  return plain == TaskState::Running ? component->nominal_states()[sub_state - 1]
                                     : component->error_states()[sub_state - 1];
}

Result<type::Value> Task::Implementation::call(std::string_view operation, const type::Value& arguments,
                                               TimePoint deadline) {
  const OperationBase* found = component->find_operation(operation);
  if (found == nullptr) {
    return fail(ErrorCode::NotFound,
                "there is no operation " + quote(operation) +
                    did_you_mean_or_list(operation, names_of(component->operations()), "it has"),
                name);
  }
  auto prepared = found->prepare(arguments);
  if (!prepared) {
    Error error = std::move(prepared.error());
    error.subject = name;
    return error;
  }
  if (found->info().runs_in == RunsIn::CallerThread || ownership.is_mine()) {
    if (auto error = detail::run_guarded(**prepared, found->name())) return std::move(*error);
    return (*prepared)->result();
  }
  return call_in_thread(std::move(*prepared), found->name(), deadline);
}

Result<type::Value> Task::Implementation::call_in_thread(std::unique_ptr<OperationCall> prepared,
                                                         const std::string& operation, TimePoint deadline) {
  auto pending = std::make_shared<detail::PendingCall>(std::move(prepared), operation, deadline);
  if (!calls.push(pending)) {
    return fail(ErrorCode::ResourceExhausted, "too many calls wait for the task; try again later", name);
  }
  if (executor->is_current()) {
    // This is the task's own thread, so nobody else would serve the call while it waits.
    auto served = exclusive("call an operation of", deadline, [this]() -> Result<void> {
      serve_calls();
      return {};
    });
    if (!served) return std::move(served.error());
  } else {
    executor->trigger(*this, Job::kCall);
  }
  return pending->wait();
}

Result<std::unique_ptr<Task>> Task::create(std::string id, std::unique_ptr<Component> component,
                                           const Activity* activity) {
  const Activity wanted = activity == nullptr ? component->options().activity : *activity;
  if (auto checked = check_activity(id, wanted); !checked) return std::move(checked.error());
  auto executor = ExecutorSet::of_process().executor_for(id, wanted);
  if (!executor) return std::move(executor.error());
  return create(std::move(id), std::move(component), wanted, std::move(*executor));
}

Result<std::unique_ptr<Task>> Task::create(std::string id, std::unique_ptr<Component> component,
                                           const Activity& activity, std::shared_ptr<Executor> executor) {
  if (auto checked = check_activity(id, activity); !checked) return std::move(checked.error());
  if (auto checked = check_names(*component, id); !checked) return std::move(checked.error());
  std::unique_ptr<Task> task(new Task(
      std::make_unique<Implementation>(std::move(id), std::move(component), activity, std::move(executor))));
  task->implementation_->task = task.get();
  return task;
}

Result<std::unique_ptr<Task>> Task::renew(Task& old, const Activity& activity,
                                          std::shared_ptr<Executor> executor, Deadline deadline) {
  Implementation& before = *old.implementation_;
  if (auto checked = check_activity(before.name, activity); !checked) return std::move(checked.error());
  std::unique_ptr<Task> task;
  auto done = before.exclusive("renew", deadline, [&]() -> Result<void> {
    if (before.state() != TaskState::PreOperational) return before.illegal("renew", "pre_operational");
    task.reset(new Task(std::make_unique<Implementation>(before, activity, std::move(executor))));
    task->implementation_->task = task.get();
    before.retired = true;
    before.serve_calls();
    return {};
  });
  if (!done) return std::move(done.error());
  return task;
}

Task::Task(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
Task::~Task() = default;

const std::string& Task::id() const {
  return implementation_->name;
}

Component& Task::component() {
  return *implementation_->component;
}

const Component& Task::component() const {
  return *implementation_->component;
}

Result<void> Task::configure(Deadline deadline) {
  return implementation_->exclusive("configure", deadline, [this] { return implementation_->configure(); });
}

Result<void> Task::start(Deadline deadline) {
  return implementation_->exclusive("start", deadline, [this] { return implementation_->start(); });
}

Result<void> Task::stop(Deadline deadline) {
  return implementation_->exclusive("stop", deadline, [this] { return implementation_->stop(); });
}

Result<void> Task::cleanup(Deadline deadline) {
  return implementation_->exclusive("clean up", deadline, [this] { return implementation_->cleanup(); });
}

Result<void> Task::recover(Deadline deadline) {
  return implementation_->exclusive("recover", deadline, [this] { return implementation_->recover(); });
}

Result<std::optional<SavedState>> Task::save_state(Deadline deadline) {
  std::optional<SavedState> state;
  auto done = implementation_->exclusive("save the state of", deadline,
                                         [&] { return implementation_->save_state(state); });
  if (!done) return std::move(done.error());
  return state;
}

Result<void> Task::restore_state(const SavedState& state, Deadline deadline) {
  return implementation_->exclusive("restore the state of", deadline,
                                    [&] { return implementation_->restore_state(state); });
}

Result<void> Task::settle(Deadline deadline) {
  return implementation_->exclusive("settle", deadline, []() -> Result<void> { return {}; });
}

TaskState Task::state() const {
  return implementation_->state();
}

std::string Task::state_name() const {
  return implementation_->state_name();
}

std::string Task::error_message() const {
  return implementation_->message.load();
}

namespace {

/// A property and the value that it is to get.
struct Change {
  PropertyBase* property;
  const type::Value* value;
  std::unique_ptr<PropertyBase::Staged> staged;
};

/// All changes, each of which is checked.
Result<std::vector<Change>> stage_all(const Component& component, const type::ValueMap& values) {
  std::vector<Change> changes;
  for (const auto& [name, value] : values) {
    PropertyBase* property = component.find_property(name);
    if (property == nullptr) {
      return fail(ErrorCode::NotFound, "there is no property " + quote(name) +
                                           did_you_mean(name, names_of(component.properties())));
    }
    auto staged = property->stage(value, "properties." + name);
    if (!staged) return std::move(staged.error());
    changes.push_back({property, &value, std::move(*staged)});
  }
  return changes;
}

/// Lets the component apply live values where it wants to.
Result<void> tell_component(const std::vector<Change>& changes) {
  for (const Change& change : changes) {
    const auto& hook = change.property->on_live_set();
    if (!hook) continue;
    try {
      if (auto done = hook(*change.value); !done) return done;
    } catch (const std::exception& thrown) {
      return fail(ErrorCode::HookFailed,
                  "setting " + quote(change.property->name()) + " threw: " + thrown.what());
    } catch (...) {
      return fail(ErrorCode::HookFailed, "setting " + quote(change.property->name()) +
                                             " threw something other than a std::exception");
    }
  }
  return {};
}

Error about(const std::string& task, Error error) {
  error.subject = task;
  return error;
}

}  // namespace

Result<void> Task::set_properties(const type::Value& values, Deadline deadline) {
  Implementation& self = *implementation_;
  if (!values.is_map()) {
    return fail(ErrorCode::InvalidArgument, "properties must be a map, not " + type::describe(values),
                self.name);
  }
  const Lock lock(*self.properties_mutex);
  // Staged before the task is locked and freed afterwards, so that updates wait for the swap only.
  auto changes = stage_all(*self.component, values.as_map());
  if (!changes) return about(self.name, std::move(changes.error()));
  std::vector<std::string> not_live;
  for (const Change& change : *changes) {
    if (!change.property->live()) not_live.push_back(quote(change.property->name()));
  }
  return self.exclusive("set properties of", deadline, [&]() -> Result<void> {
    if (self.state() == TaskState::Fatal) return self.illegal("set properties", "another state");
    if (is_configured(self.state())) {
      if (!not_live.empty()) {
        return fail(ErrorCode::InvalidState,
                    "cannot set " + listed(not_live) + " in " + self.state_name() +
                        ": not live; clean the task up first",
                    self.name);
      }
      if (auto told = tell_component(*changes); !told) return about(self.name, std::move(told.error()));
    }
    for (const Change& change : *changes)
      change.staged->apply();
    if (self.is_timed()) self.trigger_on_release |= Job::kTimer;
    return {};
  });
}

Result<void> Task::extend(const std::function<void(Component&)>& add, Deadline deadline) {
  Implementation& self = *implementation_;
  const Lock lock(*self.properties_mutex);
  return self.exclusive("extend", deadline, [&]() -> Result<void> {
    if (self.state() != TaskState::PreOperational) return self.illegal("extend", "pre_operational");
    add(*self.component);
    return {};
  });
}

type::Value Task::properties() const {
  const Lock lock(*implementation_->properties_mutex);
  type::ValueMap map;
  for (const PropertyBase* property : implementation_->component->properties()) {
    map.set(property->name(), property->value());
  }
  return type::Value(std::move(map));
}

Result<type::Value> Task::call(std::string_view operation, const type::Value& arguments, Deadline deadline) {
  return implementation_->call(operation, arguments, deadline);
}

const Activity& Task::activity() const {
  return implementation_->activity;
}

Timing Task::timing() const {
  const Implementation& self = *implementation_;
  Timing timing = self.recorder.timing(*self.executor);
  timing.missed += self.progress.missed(self.executor->clock().now(), self.activity.period);
  return timing;
}

TimingHistograms Task::timing_histograms() const {
  return implementation_->recorder.histograms();
}

std::optional<std::string> Task::overdue() const {
  return implementation_->overdue();
}

void Task::announce_next_update() {
  implementation_->announces_update.store(true, std::memory_order_seq_cst);
}

void Task::set_state_listener(StateListener listener) {
  Implementation& self = *implementation_;
  const auto swap = [&]() -> Result<void> {
    std::swap(self.listener, listener);
    return {};
  };
  if (self.ownership.is_mine()) {
    static_cast<void>(swap());
  } else {
    static_cast<void>(self.exclusive("listen to", detail::kNever, swap));
  }
}

}  // namespace segue::task
