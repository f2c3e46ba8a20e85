// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/execution.hpp>

#include <segue/base/text.hpp>

#include <algorithm>
#include <exception>
#include <map>
#include <span>
#include <system_error>

namespace segue::runtime::detail {

namespace {

/// Threads that wait for hosts beside the caller's; each costs little while it waits.
constexpr std::size_t kMostHelpers = 64;

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

Error no_answer(const model::Action& action, const std::string& why) {
  return fail(ErrorCode::Internal, why, action.label());
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

/// Actions on their way to the host at the same time.
struct Execution::Batch {
  Indices indices;
  std::vector<bool> told;
  std::size_t outstanding = 0;
};

Execution::Execution(host::TaskHost& host, const model::Transition& transition, Duration action_deadline,
                     Progress progress)
    : host_(host),
      transition_(transition),
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

Execution::~Execution() {
  {
    const std::lock_guard lock(mutex_);
    leaving_ = true;
  }
  changed_.notify_all();
  for (auto& helper : helpers_) {
    helper.join();
  }
}

bool Execution::run(model::Phase phase) {
  std::unique_lock lock(mutex_);
  phase_ = phase;
  over_ = false;
  ready_.clear();
  for (std::size_t index = 0; index < records_.size(); ++index) {
    const bool here = records_[index].action.phase == phase && !records_[index].executed;
    if (here && waits_for_[index] == 0) {
      ready_.push_back(index);
    }
  }
  work(lock);
  return failed_ == kNobody && !cancelled_;
}

void Execution::work(std::unique_lock<std::mutex>& lock) {
  while (!over_) {
    if (!doubtful_.empty()) {
      settle_doubtful(lock);
    } else if (may_begin()) {
      Batch batch;
      batch.indices.swap(ready_);
      std::sort(batch.indices.begin(), batch.indices.end());
      batch.outstanding = batch.indices.size();
      batch.told.resize(batch.indices.size());
      under_way_ += batch.indices.size();
      const Duration now = RealClock::instance().now() - started_;
      for (const std::size_t index : batch.indices) {
        records_[index].started = now;
      }
      lock.unlock();
      perform(batch);
      lock.lock();
    } else if (under_way_ == 0) {
      over_ = true;
      changed_.notify_all();
    } else {
      ++idle_;
      changed_.wait(lock, [this] { return over_ || under_way_ == 0 || has_work(); });
      --idle_;
    }
  }
}

void Execution::help() {
  std::unique_lock lock(mutex_);
  while (!leaving_) {
    work(lock);
    ++idle_;
    changed_.wait(lock, [this] { return leaving_ || has_work(); });
    --idle_;
  }
}

void Execution::perform(Batch& batch) {
  const TimePoint deadline = RealClock::instance().now() + action_deadline_;
  const std::size_t first = batch.indices.front();
  std::vector<model::Action> copies;
  std::span<const model::Action> actions(&transition_.actions[first], batch.indices.size());
  if (batch.indices.back() - first + 1 != batch.indices.size()) {
    for (const std::size_t index : batch.indices) {
      copies.push_back(transition_.actions[index]);
    }
    actions = copies;
  }
  std::string missing = "the host gave no answer";
  try {
    host_.perform_all(actions, deadline,
                      [&](std::vector<host::Completed> ended) { complete(batch, std::move(ended)); });
  } catch (const std::exception& exception) {
    // A host that throws breaks its contract; it must not take the runtime along.
    missing = std::string("the host threw: ") + exception.what();
  }
  std::vector<host::Completed> rest;
  {
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; batch.outstanding > 0 && i < batch.indices.size(); ++i) {
      if (!batch.told[i]) {
        rest.push_back({i, no_answer(actions[i], missing)});
      }
    }
  }
  complete(batch, std::move(rest));
}

void Execution::complete(Batch& batch, std::vector<host::Completed> ended) {
  if (ended.empty()) {
    return;
  }
  const std::lock_guard lock(mutex_);
  for (auto& one : ended) {
    if (one.index >= batch.indices.size() || batch.told[one.index]) {
      continue;
    }
    batch.told[one.index] = true;
    --batch.outstanding;
    finish(batch.indices[one.index], std::move(one));
  }
  // Whoever brought the batch goes on by himself when all of it is done.
  if (batch.outstanding > 0 && has_work()) {
    call_help();
  }
  if (under_way_ == 0) {
    changed_.notify_all();
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
    record.took = std::min(*took, record.duration);  // a process may tell what it likes
  }
  record.error = std::move(error);
  record.executed = true;
  --under_way_;
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
  if (under_way_ == 0) {
    changed_.notify_all();
  }
}

void Execution::call_help() {
  if (idle_ > 0) {
    changed_.notify_one();
    return;
  }
  try {
    if (helpers_.size() < kMostHelpers) {
      helpers_.emplace_back([this] { help(); });
    }
  } catch (const std::system_error&) {
    // Without another thread it takes longer: whoever is busy takes it next.
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
