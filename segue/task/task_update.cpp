// SPDX-License-Identifier: Apache-2.0
#include <segue/task/input_timeout.hpp>
#include <segue/task/realtime_log.hpp>
#include <segue/task/task_implementation.hpp>

#include <algorithm>
#include <exception>

namespace segue::task {

namespace {

/// Some callers wait for ever.
constexpr Duration kLongestOperation = std::chrono::hours(24);

}  // namespace

bool Task::Implementation::active() const {
  return state() == TaskState::Running || state() == TaskState::RunTimeError;
}

[[gnu::hot]] TimePoint Task::Implementation::run(std::uint32_t reasons, TimePoint& now) noexcept {
  deferred |= reasons;
  // The holder triggers this job again when it is done.
  if (!ownership.try_acquire()) return detail::kNever;
  reasons = std::exchange(deferred, 0);
  if (!calls.empty()) serve_calls();
  if (active() && due(reasons, now)) update(now);
  if (announces_update.load(std::memory_order_relaxed)) announce_update();
  const bool timed = activity.trigger == Trigger::Periodic && active();
  const TimePoint next = timed ? due_at : next_timeout();
  release();
  return next;
}

void Task::Implementation::announce_update() noexcept {
  announces_update.store(false, std::memory_order_relaxed);
  if (listener) listener(*task, state());
}

[[gnu::hot]] bool Task::Implementation::due(std::uint32_t reasons, TimePoint now) const {
  switch (activity.trigger) {
    case Trigger::Periodic:
      return now >= due_at;
    case Trigger::PortDriven:
      return (reasons & (Job::kSample | Job::kDescriptor)) != 0 || now >= next_timeout();
    case Trigger::FileDescriptorDriven:
      return (reasons & Job::kDescriptor) != 0 || now >= next_timeout();
  }
  return false;
}

/// When an input will have gone without a sample for too long, which wakes tasks that time does not.
[[gnu::hot]] TimePoint Task::Implementation::next_timeout() const noexcept {
  TimePoint next = detail::kNever;
  if (activity.trigger == Trigger::Periodic || state() != TaskState::Running) return next;
  for (const InputTimeout* timeout : component->timeouts())
    next = std::min(next, timeout->due());
  return next;
}

[[gnu::hot]] void Task::Implementation::update(TimePoint& now) noexcept {
  const TimePoint begin = now;
  TimePoint wanted = wanted_since();
  std::uint64_t missed = 0;
  if (activity.trigger == Trigger::Periodic) {
    wanted = due_at;
    missed = static_cast<std::uint64_t>((begin - due_at) / activity.period);
    due_at += activity.period * static_cast<std::int64_t>(missed + 1);
  }
  const std::uint64_t read_before = trigger_samples_read();
  request = Request::None;
  const bool in_error = state() == TaskState::RunTimeError;
  const std::string_view hook_name = in_error ? "on_error" : "on_update";
  using What = detail::Progress::What;
  const bool periodic = activity.trigger == Trigger::Periodic;
  progress.begin(in_error ? What::Error : What::Update, begin + update_deadline,
                 periodic ? due_at : detail::kNever);
  try {
    if (in_error) {
      ComponentAccess::error(*component);
    } else {
      ComponentAccess::update(*component);
    }
  } catch (const std::exception& thrown) {
    exception(std::string(hook_name) + " threw: " + thrown.what());
  } catch (...) {
    exception(in_error ? "on_error threw something other than a std::exception"
                       : "on_update threw something other than a std::exception");
  }
  now = executor->clock().now();
  recorder.record(wanted, begin, now, activity.period, missed);
  if (!in_error) {
    for (InputTimeout* timeout : component->timeouts())
      timeout->note_update(begin, now);
  }
  if (request != Request::None) {
    static_cast<void>(collapse(hook_name, Reached::Started));
    return;
  }
  for (const int descriptor : descriptors)
    executor->rearm(*this, descriptor);
  const bool has_recovered = in_error && state() == TaskState::Running;
  if (!trigger_inputs.empty() && (has_recovered || trigger_samples_read() != read_before))
    retrigger_if_pending();
}

[[gnu::hot]] std::uint64_t Task::Implementation::trigger_samples_read() const noexcept {
  std::uint64_t count = 0;
  for (const InputPortBase* input : trigger_inputs)
    count += input->samples_read();
  return count;
}

/// One trigger may stand for several samples. A component that takes one at a time gets another turn as long
/// as it makes progress.
[[gnu::hot]] void Task::Implementation::retrigger_if_pending() noexcept {
  const auto waits = [](InputPortBase* input) { return input->pending(); };
  if (std::ranges::any_of(trigger_inputs, waits)) executor->trigger(*this, Job::kSample);
}

void Task::Implementation::serve_calls() noexcept {
  if (retired) {
    calls.take_all([](detail::PendingCall& call) { call.cancel(); });
    return;
  }
  request = Request::None;
  calls.take_all([this](detail::PendingCall& call) {
    note_operation(call.deadline());
    call.run();
  });
  if (request == Request::None) return;
  const Reached reached = active()                 ? Reached::Started
                          : is_configured(state()) ? Reached::Configured
                                                   : Reached::Nothing;
  static_cast<void>(collapse("an operation", reached));
}

/// An operation may take as long as its caller waits, and as an update.
void Task::Implementation::note_operation(TimePoint caller_deadline) noexcept {
  const TimePoint now = executor->clock().now();
  const Duration wanted = caller_deadline - RealClock::instance().now();
  const Duration limit = std::min(std::max(wanted, update_deadline), kLongestOperation);
  const bool periodic = active() && activity.trigger == Trigger::Periodic;
  progress.begin(detail::Progress::What::Operation, now + limit, periodic ? due_at : detail::kNever);
}

[[gnu::hot]] void Task::Implementation::release() noexcept {
  progress.end();
  std::uint32_t reasons = std::exchange(trigger_on_release, 0);
  if (ownership.release()) reasons |= Job::kRetry;
  if (reasons != 0) executor->trigger(*this, static_cast<Job::Reason>(reasons));
}

void Task::Implementation::set_state(std::uint32_t sub_state) {
  if (starting) {
    state_at_start = sub_state;
    return;
  }
  if (state() != TaskState::Running) {
    RealtimeLog::instance().push(LogLevel::Warning, name,
                                 "a state entered outside of start and running: ignored");
    return;
  }
  if (state_word.load(std::memory_order_relaxed) >> 8U != sub_state) enter(TaskState::Running, sub_state);
}

void Task::Implementation::error(std::uint32_t sub_state, std::string_view text) {
  if (!active() && !starting) {
    RealtimeLog::instance().push(LogLevel::Warning, name, "error() outside of start and update: ignored");
    return;
  }
  message.store(text);
  if (starting) {
    error_at_start = sub_state + 1;
  } else {
    enter(TaskState::RunTimeError, sub_state);
  }
}

void Task::Implementation::recovered() {
  if (state() != TaskState::RunTimeError) return;
  message.store("");
  enter(TaskState::Running);
}

void Task::Implementation::exception(std::string_view text) {
  message.store(text);
  if (request == Request::None) request = Request::Exception;
}

void Task::Implementation::fatal(std::string_view text) {
  message.store(text);
  request = Request::Fatal;
}

}  // namespace segue::task
