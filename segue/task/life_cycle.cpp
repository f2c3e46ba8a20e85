// SPDX-License-Identifier: Apache-2.0
#include <segue/base/log.hpp>
#include <segue/base/text.hpp>
#include <segue/task/input_timeout.hpp>
#include <segue/task/port_access.hpp>
#include <segue/task/realtime_log.hpp>
#include <segue/task/task_implementation.hpp>

#include <algorithm>
#include <exception>

namespace segue::task {

template <class Hook>
Task::Implementation::HookEnd Task::Implementation::run_hook(std::string_view hook_name, Hook hook) {
  HookEnd end;
  request = Request::None;
  try {
    if (Result<void> done = hook(*component); !done) end.refused = std::move(done.error());
  } catch (const std::exception& thrown) {
    exception(std::string(hook_name) + " threw: " + thrown.what());
  } catch (...) {
    exception(std::string(hook_name) + " threw something other than a std::exception");
  }
  end.broke = request != Request::None;
  return end;
}

namespace {

/// Adapts hooks that cannot fail.
template <void (*kHook)(Component&)>
Result<void> always(Component& component) {
  kHook(component);
  return {};
}

}  // namespace

Error Task::Implementation::illegal(std::string_view verb, std::string_view needed) const {
  return fail(ErrorCode::InvalidState,
              "cannot " + std::string(verb) + " in " + state_name() + "; needs " + std::string(needed), name);
}

/// Whether time can make it update.
bool Task::Implementation::is_timed() const {
  return activity.trigger == Trigger::Periodic || !component->timeouts().empty();
}

Result<void> Task::Implementation::configure() {
  if (state() != TaskState::PreOperational) return illegal("configure", "pre_operational");
  HookEnd end = run_hook("on_configure", &ComponentAccess::configure);
  if (end.broke) return collapse("on_configure", Reached::Configured);
  if (end.refused) return refused("on_configure", std::move(*end.refused));
  enter(TaskState::Stopped);
  return {};
}

Result<void> Task::Implementation::start() {
  if (state() != TaskState::Stopped) return illegal("start", "stopped");
  recorder.reset(*executor);
  error_at_start = 0;
  state_at_start = 0;
  message.store("");
  starting = true;
  HookEnd end = run_hook("on_start", &ComponentAccess::start);
  starting = false;
  if (end.broke) return collapse("on_start", Reached::Started);
  if (end.refused) {
    disarm();
    return refused("on_start", std::move(*end.refused));
  }
  if (auto armed = arm(); !armed) {
    disarm();
    end = run_hook("on_stop", &always<&ComponentAccess::stop>);
    if (end.broke) return collapse("on_stop", Reached::Configured);
    return armed;
  }
  due_at = executor->clock().now();
  for (InputTimeout* timeout : component->timeouts())
    timeout->begin(due_at);
  enter(TaskState::Running, state_at_start);
  if (is_timed()) trigger_on_release |= Job::kTimer;
  const auto waits = [](InputPortBase* input) { return input->pending(); };
  if (std::ranges::any_of(trigger_inputs, waits)) trigger_on_release |= Job::kSample;
  if (error_at_start == 0) return {};
  enter(TaskState::RunTimeError, error_at_start - 1);
  return fail(ErrorCode::HookFailed, "on_start reported an error: " + message.load(), name);
}

Result<void> Task::Implementation::stop() {
  if (state() != TaskState::Running && state() != TaskState::RunTimeError) {
    return illegal("stop", "running or run_time_error");
  }
  disarm();
  const HookEnd end = run_hook("on_stop", &always<&ComponentAccess::stop>);
  if (end.broke) return collapse("on_stop", Reached::Configured);
  enter(TaskState::Stopped);
  return {};
}

Result<void> Task::Implementation::cleanup() {
  if (state() != TaskState::Stopped) return illegal("clean up", "stopped");
  const HookEnd end = run_hook("on_cleanup", &always<&ComponentAccess::cleanup>);
  if (end.broke) return collapse("on_cleanup", Reached::Nothing);
  enter(TaskState::PreOperational);
  return {};
}

Result<void> Task::Implementation::recover() {
  const TaskState before = state();
  if (before != TaskState::RunTimeError && before != TaskState::Exception) {
    return illegal("recover", "run_time_error or exception");
  }
  HookEnd end = run_hook("on_recover", &ComponentAccess::recover);
  if (end.broke) {
    return collapse("on_recover", before == TaskState::RunTimeError ? Reached::Started : Reached::Nothing);
  }
  if (end.refused) return refused("on_recover", std::move(*end.refused));
  message.store("");
  enter(before == TaskState::RunTimeError ? TaskState::Running : TaskState::PreOperational);
  if (is_timed()) trigger_on_release |= Job::kTimer;
  const auto waits = [](InputPortBase* input) { return input->pending(); };
  if (std::ranges::any_of(trigger_inputs, waits)) trigger_on_release |= Job::kSample;
  return {};
}

/// An exception does not change the state, since the task may be started again if the hand-over fails.
Result<void> Task::Implementation::save_state(std::optional<SavedState>& saved) {
  if (state() != TaskState::Stopped) return illegal("save the state", "stopped");
  request = Request::None;
  try {
    saved = ComponentAccess::save_state(*component);
  } catch (const std::exception& thrown) {
    return fail(ErrorCode::HookFailed, std::string("save_state threw: ") + thrown.what(), name);
  } catch (...) {
    return fail(ErrorCode::HookFailed, "save_state threw something other than a std::exception", name);
  }
  if (request != Request::None) return collapse("save_state", Reached::Configured);
  return {};
}

Result<void> Task::Implementation::restore_state(const SavedState& given) {
  if (state() != TaskState::Stopped) return illegal("restore a state", "stopped");
  HookEnd end = run_hook("restore_state",
                         [&](Component& target) { return ComponentAccess::restore_state(target, given); });
  if (end.broke) return collapse("restore_state", Reached::Configured);
  if (end.refused) return refused("restore_state", std::move(*end.refused));
  return {};
}

void Task::Implementation::shut_down() {
  const TaskState before = state();
  if (before == TaskState::Running || before == TaskState::RunTimeError) {
    disarm();
    undo("on_stop", &ComponentAccess::stop);
  }
  if (is_configured(before)) undo("on_cleanup", &ComponentAccess::cleanup);
  state_word.store(static_cast<std::uint32_t>(TaskState::PreOperational), std::memory_order_release);  // V1
}

/// Undoes the steps up to `reached` and enters Exception or Fatal, after a hook threw or requested it.
Result<void> Task::Implementation::collapse(std::string_view hook_name, Reached reached) {
  const bool is_fatal = request == Request::Fatal;
  const std::string why = message.load();
  disarm();
  if (!is_fatal && reached == Reached::Started) undo("on_stop", &ComponentAccess::stop);
  if (!is_fatal && reached != Reached::Nothing) undo("on_cleanup", &ComponentAccess::cleanup);
  request = Request::None;
  message.store(why);
  enter(is_fatal ? TaskState::Fatal : TaskState::Exception);
  return fail(ErrorCode::HookFailed,
              why + " (in " + std::string(hook_name) + "); the task is now in " + state_name(), name);
}

void Task::Implementation::undo(std::string_view hook_name, void (*hook)(Component&)) {
  const HookEnd end = run_hook(hook_name, [&](Component& target) -> Result<void> {
    hook(target);
    return {};
  });
  if (end.broke) RealtimeLog::instance().push(LogLevel::Error, name, message.load());
}

Result<void> Task::Implementation::refused(std::string_view hook_name, Error why) {
  return fail(ErrorCode::HookFailed, std::string(hook_name) + " failed", name).because_of(std::move(why));
}

Result<void> Task::Implementation::trigger_fd(int descriptor, std::string_view descriptor_name) {
  if (!starting || activity.trigger == Trigger::Periodic) {
    return fail(ErrorCode::InvalidState,
                "trigger_fd() can only be called in on_start of a task that is driven by file descriptors or "
                "by ports; this one is " +
                    std::string(to_string(activity.trigger)),
                name);
  }
  const auto& known = component->options().descriptors;
  if (!descriptor_name.empty() && std::ranges::find(known, descriptor_name) == known.end()) {
    return fail(ErrorCode::InvalidArgument,
                "the options of the component do not name the descriptor " + quote(descriptor_name) +
                    did_you_mean(descriptor_name, known),
                name);
  }
  given_descriptors.emplace(descriptor_name);
  // Those of a task that is driven by ports name inputs.
  if (activity.trigger == Trigger::PortDriven || activity.triggers.empty() ||
      activity.triggers.contains(std::string(descriptor_name)))
    descriptors.push_back(descriptor);
  return {};
}

/// Connects the task to its triggers: samples, descriptors and time.
Result<void> Task::Implementation::arm() {
  trigger_inputs.clear();
  if (activity.trigger == Trigger::PortDriven) {
    const std::vector<std::string>& own = component->options().trigger_on;
    const std::set<std::string> wanted =
        activity.triggers.empty() ? std::set(own.begin(), own.end()) : activity.triggers;
    const std::vector<InputPortBase*> inputs = component->inputs();
    for (InputPortBase* input : inputs) {
      if (wanted.empty() || wanted.contains(input->name())) {
        trigger_inputs.push_back(input);
      }
    }
    for (const std::string& port : wanted) {
      if (component->find_input(port) != nullptr) continue;
      std::vector<std::string> names;
      for (const InputPortBase* input : inputs)
        names.push_back(input->name());
      return fail(
          ErrorCode::NotFound,
          "there is no input port " + quote(port) + " to trigger the task" + did_you_mean(port, names), name);
    }
  }
  for (InputPortBase* input : trigger_inputs)
    InputPortAccess::set_listener(*input, this);
  return watch_descriptors();
}

Result<void> Task::Implementation::watch_descriptors() {
  const bool must_have_some = activity.trigger == Trigger::FileDescriptorDriven;
  for (const std::string& wanted : activity.triggers) {
    if (!must_have_some || given_descriptors.contains(wanted)) continue;
    return fail(ErrorCode::NotFound,
                "on_start gave no file descriptor " + quote(wanted) + " to trigger the task", name);
  }
  for (const int descriptor : descriptors) {
    if (auto watched = executor->watch(*this, descriptor); !watched) return watched;
  }
  if (must_have_some && descriptors.empty()) {
    segue::log(LogLevel::Warning, name,
               "is driven by file descriptors, but on_start gave none, so it never updates");
  }
  return {};
}

void Task::Implementation::disarm() {
  for (InputPortBase* input : trigger_inputs)
    InputPortAccess::set_listener(*input, nullptr);
  trigger_inputs.clear();
  for (const int descriptor : descriptors)
    executor->unwatch(descriptor);
  descriptors.clear();
  given_descriptors.clear();
}

/// Sets the state, writes it to the state port and calls the listener.
void Task::Implementation::enter(TaskState state, std::uint32_t sub_state) {
  state_word.store(static_cast<std::uint32_t>(state) | (sub_state << 8U), std::memory_order_release);  // V1
  std::int32_t number = static_cast<std::int32_t>(state);
  if (sub_state > 0) {
    const std::int32_t first = state == TaskState::Running ? kFirstNominalState : kFirstErrorState;
    number = first + static_cast<std::int32_t>(sub_state) - 1;
  }
  ComponentAccess::state_port(*component).write(number);
  if (listener) listener(*task, state);
}

}  // namespace segue::task
