// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/execution.hpp>

#include <segue/base/text.hpp>

#include <algorithm>

namespace segue::runtime::detail {

namespace {

/// A host that keeps deadlines answers by itself; only one that hangs is given up, this much later.
constexpr Duration kGrace = std::chrono::milliseconds(20);

std::vector<ActionRecord> empty_records(const std::vector<model::Action>& actions) {
  std::vector<ActionRecord> records;
  records.reserve(actions.size());
  for (const auto& action : actions) {
    records.push_back({action, {}, {}, std::nullopt, false});
  }
  return records;
}

Error overdue(const model::Action& action, Duration deadline) {
  return fail(ErrorCode::DeadlineExceeded,
              "has not ended within " + format_duration(deadline) +
                  "; it may still be at work, so look at the task's true state",
              action.label());
}

bool task_is(const model::Network& observed, const model::Action& action, TaskState state) {
  const model::Task* task = observed.find_task(*action.task());
  return task != nullptr && task->state == state;
}

bool has_deployment(const model::Network& observed, const model::Action& action) {
  const auto& wanted = std::get<model::DeploymentAction>(action.what).deployment;
  return std::any_of(observed.deployments.begin(), observed.deployments.end(),
                     [&](const model::Deployment& deployment) { return deployment.key() == wanted.key(); });
}

bool has_connection(const model::Network& observed, const model::Action& action) {
  const auto& wanted = std::get<model::ConnectionAction>(action.what).connection;
  return std::find(observed.connections.begin(), observed.connections.end(), wanted) !=
         observed.connections.end();
}

/// A host that throws breaks its contract; it must not take the runtime along.
Result<void> perform_guarded(host::TaskHost& host, const model::Action& action, TimePoint deadline) {
  try {
    return host.perform(action, deadline);
  } catch (const std::exception& exception) {
    return fail(ErrorCode::Internal, std::string("the host threw: ") + exception.what(), action.label());
  }
}

}  // namespace

bool took_effect(const model::Action& action, const model::Network& observed) {
  switch (action.kind) {
    case model::ActionKind::Stop:
    case model::ActionKind::Configure:
      return task_is(observed, action, TaskState::Stopped);
    case model::ActionKind::Cleanup:
      return task_is(observed, action, TaskState::PreOperational);
    case model::ActionKind::Start:
      return task_is(observed, action, TaskState::Running);
    case model::ActionKind::Deploy:
      return has_deployment(observed, action);
    case model::ActionKind::Undeploy:
      return !has_deployment(observed, action);
    case model::ActionKind::Connect:
      return has_connection(observed, action);
    case model::ActionKind::Disconnect:
      return !has_connection(observed, action);
    default:
      return false;
  }
}

Execution::Execution(host::TaskHost& host, const std::vector<model::Action>& actions,
                     Duration action_deadline, Progress progress)
    : host_(host),
      action_deadline_(action_deadline),
      progress_(std::move(progress)),
      started_(RealClock::instance().now()),
      records_(empty_records(actions)),
      due_(started_ + action_deadline) {
  thread_ = std::thread([this] { run(); });
}

Execution::~Execution() {
  cancel();
  thread_.join();
}

void Execution::run() {
  for (std::size_t index = 0; begin(index); ++index) {
    // Nobody but this thread changes the action of a record; its other fields are guarded.
    const model::Action& action = records_[index].action;
    const TimePoint started = RealClock::instance().now();
    auto done = perform_guarded(host_, action, started + action_deadline_);
    std::optional<Error> error = done ? std::nullopt : std::optional(std::move(done.error()));
    if (error && error->code == ErrorCode::DeadlineExceeded && took_effect(action, host_.observe())) {
      error.reset();
    }
    if (!finish(index, std::move(error), started)) {
      break;
    }
  }
  const std::lock_guard lock(mutex_);
  ended_ = true;
  changed_.notify_all();
}

bool Execution::begin(std::size_t index) {
  const std::lock_guard lock(mutex_);
  if (cancelled_ || index >= records_.size()) {
    return false;
  }
  current_ = index;
  records_[index].started = RealClock::instance().now() - started_;
  due_ = RealClock::instance().now() + action_deadline_;
  return true;
}

bool Execution::finish(std::size_t index, std::optional<Error> error, TimePoint started) {
  ActionRecord record;
  {
    const std::lock_guard lock(mutex_);
    if (records_[index].executed) {
      return false;  // it came too late and has been given up
    }
    records_[index].duration = RealClock::instance().now() - started;
    records_[index].error = std::move(error);
    records_[index].executed = true;
    record = records_[index];
  }
  progress_(record);
  return !record.error;
}

bool Execution::abandon(std::size_t index) {
  ActionRecord record;
  {
    const std::lock_guard lock(mutex_);
    if (records_[index].executed) {
      return false;
    }
    cancelled_ = true;
    records_[index].duration = RealClock::instance().now() - started_ - records_[index].started;
    records_[index].error = overdue(records_[index].action, action_deadline_);
    records_[index].executed = true;
    record = records_[index];
  }
  progress_(record);
  return true;
}

void Execution::wait() {
  std::unique_lock lock(mutex_);
  while (!ended_) {
    const TimePoint give_up = due_ + kGrace;
    const std::size_t index = current_;
    if (changed_.wait_until(lock, give_up, [&] { return ended_; })) {
      return;
    }
    const bool is_overdue = index == current_ && due_ + kGrace <= RealClock::instance().now();
    if (!is_overdue) {
      continue;
    }
    lock.unlock();
    if (abandon(index)) {
      return;
    }
    lock.lock();
  }
}

void Execution::cancel() {
  const std::lock_guard lock(mutex_);
  cancelled_ = true;
}

bool Execution::ended() const {
  const std::lock_guard lock(mutex_);
  return ended_;
}

std::vector<ActionRecord> Execution::records() const {
  const std::lock_guard lock(mutex_);
  return records_;
}

}  // namespace segue::runtime::detail
