// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/execution.hpp>

#include <segue/base/text.hpp>

#include <algorithm>
#include <exception>
#include <map>
#include <memory>

namespace segue::runtime::detail {

namespace {

/// Hosts report what is overdue themselves; only one that does not is given up.
constexpr Duration kHostGrace = std::chrono::seconds(30);

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

Execution::Execution(host::TaskHost& host, const model::Transition& transition, Duration action_deadline,
                     Progress progress)
    : host_(host),
      action_deadline_(action_deadline),
      progress_(std::move(progress)),
      started_(RealClock::instance().now()),
      successors_(transition.actions.size()),
      waits_for_(transition.actions.size()) {
  std::map<int, std::size_t> index_of;
  records_.reserve(transition.actions.size());
  for (std::size_t index = 0; index < transition.actions.size(); ++index) {
    const model::Action& action = transition.actions[index];
    records_.push_back({action, {}, {}, std::nullopt, false});
    index_of.emplace(action.id, index);
    for (const int before : action.after) {
      const auto found = index_of.find(before);
      if (found != index_of.end()) {
        successors_[found->second].push_back(index);
        ++waits_for_[index];
      }
    }
  }
}

bool Execution::run(model::Phase phase) {
  std::unique_lock lock(mutex_);
  phase_ = phase;
  ready_.clear();
  batches_.clear();
  for (std::size_t index = 0; index < records_.size(); ++index) {
    const bool here = records_[index].action.phase == phase && !records_[index].executed;
    if (here && waits_for_[index] == 0) {
      ready_.push_back(index);
    }
  }
  while (true) {
    if (!doubtful_.empty()) {
      settle_doubtful(lock);
    } else if (may_begin()) {
      begin_ready(lock);
    } else if (in_progress_ > 0 || !beginning_.empty()) {
      wait(lock);
    } else {
      return failed_ == kNobody && !cancelled_;
    }
  }
}

void Execution::wait(std::unique_lock<std::mutex>& lock) {
  TimePoint last = RealClock::instance().now();
  for (const auto& batch : batches_) {
    last = std::max(last, batch->deadline);
  }
  const bool in_time = changed_.wait_until(lock, last + kHostGrace, [this] {
    return !doubtful_.empty() || may_begin() || (in_progress_ == 0 && beginning_.empty());
  });
  if (!in_time && RealClock::instance().now() > last + kHostGrace) {
    for (const auto& batch : batches_) {
      fail_batch(*batch, "the host did not report how it ended");
    }
  }
}

void Execution::begin_ready(std::unique_lock<std::mutex>& lock) {
  const auto me = std::this_thread::get_id();
  if (!beginning_.insert(me).second) {
    return;  // the host reports while this thread calls it, which goes on below afterwards
  }
  while (may_begin()) {
    const auto batch = take_ready();
    std::vector<model::Action> actions;
    for (const std::size_t index : batch->indices) {
      actions.push_back(records_[index].action);
    }
    lock.unlock();
    std::string thrown;
    try {
      host_.begin_all(std::move(actions), batch->deadline,
                      [self = shared_from_this(), batch](std::vector<host::Completed> ended) {
                        self->complete(*batch, std::move(ended));
                      });
    } catch (const std::exception& exception) {
      thrown = std::string("the host threw: ") + exception.what();
    }
    lock.lock();
    if (!thrown.empty()) {
      fail_batch(*batch, thrown);
    }
  }
  beginning_.erase(me);
  if (beginning_.empty() && in_progress_ == 0) {
    changed_.notify_all();
  }
}

Execution::BatchPtr Execution::take_ready() {
  const TimePoint now = RealClock::instance().now();
  const auto batch = std::make_shared<Batch>();
  batch->indices.swap(ready_);
  std::sort(batch->indices.begin(), batch->indices.end());
  batch->reported.resize(batch->indices.size());
  batch->deadline = now + action_deadline_;
  for (const std::size_t index : batch->indices) {
    records_[index].started = now - started_;
  }
  in_progress_ += batch->indices.size();
  batches_.push_back(batch);
  return batch;
}

void Execution::complete(Batch& batch, std::vector<host::Completed> ended) {
  std::unique_lock lock(mutex_);
  for (auto& one : ended) {
    if (one.index < batch.indices.size() && !batch.reported[one.index]) {
      batch.reported[one.index] = true;
      finish(batch.indices[one.index], std::move(one));
    }
  }
  begin_ready(lock);
  if (in_progress_ == 0 || !doubtful_.empty()) {
    changed_.notify_all();
  }
}

void Execution::fail_batch(Batch& batch, const std::string& why) {
  for (std::size_t i = 0; i < batch.indices.size(); ++i) {
    if (!batch.reported[i]) {
      batch.reported[i] = true;
      const std::size_t index = batch.indices[i];
      record(index, fail(ErrorCode::Internal, why, records_[index].action.label()), std::nullopt);
    }
  }
}

void Execution::finish(std::size_t index, host::Completed ended) {
  auto& outcome = ended.outcome;
  if (!outcome && outcome.error().code == ErrorCode::DeadlineExceeded) {
    doubtful_.emplace_back(index, std::move(outcome.error()));
    return;
  }
  record(index, outcome ? std::nullopt : std::optional(std::move(outcome.error())), ended.took);
}

void Execution::record(std::size_t index, std::optional<Error> error, std::optional<Duration> took) {
  ActionRecord& record = records_[index];
  record.duration = RealClock::instance().now() - started_ - record.started;
  if (took) {
    record.took = std::min(*took, record.duration);  // another process may report anything
  }
  record.error = std::move(error);
  record.executed = true;
  --in_progress_;
  if (!record.error) {
    release_successors(index);
  } else if (failed_ == kNobody) {
    failed_ = index;
  }
  progress_(record);
}

void Execution::release_successors(std::size_t index) {
  for (const std::size_t next : successors_[index]) {
    if (--waits_for_[next] == 0 && records_[next].action.phase == phase_) {
      ready_.push_back(next);
    }
  }
}

void Execution::settle_doubtful(std::unique_lock<std::mutex>& lock) {
  const auto doubtful = std::exchange(doubtful_, {});
  lock.unlock();
  const model::Network observed = host_.observe();
  lock.lock();
  for (const auto& [index, error] : doubtful) {
    const bool done = took_effect(records_[index].action, observed);
    record(index, done ? std::nullopt : std::optional(error), std::nullopt);
  }
}

void Execution::cancel() {
  const std::lock_guard lock(mutex_);
  cancelled_ = true;
}

const ActionRecord* Execution::failure() const {
  return failed_ == kNobody ? nullptr : &records_[failed_];
}

Duration Execution::window(model::Phase phase) const {
  Duration begin = Duration::max();
  Duration end{0};
  for (const auto& record : records_) {
    if (record.executed && record.action.phase == phase) {
      begin = std::min(begin, record.started);
      end = std::max(end, record.started + record.duration);
    }
  }
  return begin == Duration::max() ? Duration{0} : end - begin;
}

}  // namespace segue::runtime::detail
