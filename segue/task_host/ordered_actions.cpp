// SPDX-License-Identifier: Apache-2.0
#include <segue/task_host/action_effect.hpp>
#include <segue/task_host/ordered_actions.hpp>

#include <algorithm>
#include <exception>
#include <map>

namespace segue::task_host {

namespace {

/// Hosts report overdue actions themselves; only a host that does not is given up.
constexpr Duration kHostGrace = std::chrono::seconds(30);
/// No longer chain is waited for, so that deadlines stay within the range of clocks.
constexpr int kMostSteps = 10'000;

}  // namespace

int longest_chain(const std::vector<model::Action>& actions) {
  std::map<int, int> lengths;  // of the chain that ends with the action of that id
  int longest = 0;
  for (const auto& action : actions) {
    int length = 1;
    for (const int before : action.after) {
      const auto found = lengths.find(before);
      if (found != lengths.end()) {
        length = std::max(length, found->second + 1);
      }
    }
    lengths.emplace(action.id, length);
    longest = std::max(longest, length);
  }
  return longest;
}

OrderedActions::OrderedActions(std::vector<model::Action> actions, Duration action_deadline,
                               Performer performer, Completion completed)
    : actions_(std::move(actions)),
      action_deadline_(action_deadline),
      performer_(std::move(performer)),
      completed_(std::move(completed)),
      started_(RealClock::instance().now()),
      successors_(actions_.size()),
      waits_for_(actions_.size()),
      progress_(actions_.size(), Progress::Waiting) {
  std::map<int, std::size_t> index_of;
  for (std::size_t index = 0; index < actions_.size(); ++index) {
    index_of.emplace(actions_[index].id, index);
  }
  for (std::size_t index = 0; index < actions_.size(); ++index) {
    for (const int before : actions_[index].after) {
      const auto found = index_of.find(before);
      if (found != index_of.end() && found->second != index) {
        successors_[found->second].push_back(index);
        ++waits_for_[index];
      }
    }
    if (waits_for_[index] == 0) {
      ready_.push_back(index);
    }
  }
}

void OrderedActions::run(const EarlyEnd& early_end) {
  const std::stop_callback cancelling(early_end.stop, [this] { cancel(); });
  left_ended_ = early_end.left_ended;
  const Leaving::Handler leaving(early_end.leaving, [this](const auto& may_be_left) { leave(may_be_left); });
  Lock lock(mutex_);
  while (true) {
    if (!timed_out_.empty()) {
      settle_doubtful();
    } else if (may_begin()) {
      begin_ready();
    } else if (!is_idle()) {
      wait();
    } else {
      return report_unbegun();
    }
  }
}

void OrderedActions::wait() {
  TimePoint last = RealClock::instance().now();
  for (const auto& batch : batches_) {
    last = std::max(last, batch->deadline);
  }
  const bool in_time = changed_.wait_until(mutex_, last + kHostGrace, [this]() SEGUE_REQUIRES(mutex_) {
    return !timed_out_.empty() || may_begin() || is_idle();
  });
  if (!in_time && RealClock::instance().now() > last + kHostGrace) {
    for (const auto& batch : batches_) {
      fail_batch(*batch, "the host did not report how it ended");
    }
    deliver();
  }
}

void OrderedActions::begin_ready() {
  const auto me = std::this_thread::get_id();
  if (!beginning_.insert(me).second) {
    return;  // the performer reports while this thread calls it, which goes on below afterwards
  }
  while (may_begin()) {
    const auto batch = take_ready();
    std::vector<model::Action> actions = actions_of(*batch);
    batch->deadline = batch->begin + action_deadline_ * std::min(longest_chain(actions), kMostSteps);
    std::string thrown;
    try {
      const Unlocked unlocked(mutex_);
      performer_.begin(std::move(actions), batch->deadline,
                       [self = shared_from_this(), batch](std::vector<Completed> ended) {
                         self->complete(*batch, std::move(ended));
                       });
    } catch (const std::exception& exception) {
      thrown = std::string("the host threw: ") + exception.what();
    }
    if (!thrown.empty()) {
      fail_batch(*batch, thrown);
    }
  }
  beginning_.erase(me);
  begin_no_more();
  deliver();
  if (is_idle()) {
    changed_.notify_all();
  }
}

OrderedActions::BatchPtr OrderedActions::take_ready() {
  auto batch = std::make_shared<Batch>();
  batch->indices.swap(ready_);
  if (performer_.place) {
    add_dependent(batch->indices);
  }
  std::sort(batch->indices.begin(), batch->indices.end());
  batch->reported.resize(batch->indices.size());
  batch->left.resize(batch->indices.size());
  batch->begin = RealClock::instance().now();
  for (const std::size_t index : batch->indices) {
    progress_[index] = Progress::Begun;
  }
  in_progress_ += batch->indices.size();
  batches_.push_back(batch);
  return batch;
}

void OrderedActions::add_dependent(Indices& indices) const {
  std::map<std::size_t, int> waits_inside;  // for how many of the batch
  for (std::size_t next = 0; next < indices.size(); ++next) {
    const std::size_t index = indices[next];
    const void* place = performer_.place(actions_[index]);
    if (place == nullptr) {
      continue;
    }
    for (const std::size_t successor : successors_[index]) {
      const bool is_there = performer_.place(actions_[successor]) == place;
      if (is_there && ++waits_inside[successor] == waits_for_[successor]) {
        indices.push_back(successor);
      }
    }
  }
}

std::vector<model::Action> OrderedActions::actions_of(const Batch& batch) const {
  std::vector<model::Action> actions;
  for (const std::size_t index : batch.indices) {
    actions.push_back(actions_[index]);
  }
  return actions;
}

void OrderedActions::complete(Batch& batch, std::vector<Completed> ended) {
  // Actions that a failure kept from beginning come last, since they are not the failure.
  std::stable_partition(ended.begin(), ended.end(), [](const Completed& one) { return one.begun; });
  Lock lock(mutex_);
  Indices late;
  for (auto& one : ended) {
    if (one.index >= batch.indices.size()) {
      continue;
    }
    const std::size_t index = batch.indices[one.index];
    if (batch.left[one.index]) {
      batch.left[one.index] = false;
      late.push_back(index);
    } else if (!batch.reported[one.index]) {
      batch.reported[one.index] = true;
      finish(batch, index, std::move(one));
    }
  }
  begin_no_more();
  begin_ready();
  deliver();
  if (is_idle() || !timed_out_.empty()) {
    changed_.notify_all();
  }
  lock.unlock();
  tell_left_ended(late);
}

void OrderedActions::tell_left_ended(const Indices& indices) {
  for (const std::size_t index : indices) {
    if (left_ended_) {
      left_ended_(actions_[index]);
    }
  }
}

void OrderedActions::deliver() {
  if (delivering_) {
    return;
  }
  delivering_ = true;
  while (!undelivered_.empty()) {
    auto ended = std::exchange(undelivered_, {});
    const Unlocked unlocked(mutex_);
    completed_(std::move(ended));
  }
  delivering_ = false;
}

void OrderedActions::fail_batch(Batch& batch, const std::string& why) {
  for (std::size_t i = 0; i < batch.indices.size(); ++i) {
    if (!batch.reported[i]) {
      batch.reported[i] = true;
      const std::size_t index = batch.indices[i];
      finish(batch, index, {index, fail(ErrorCode::Internal, why, actions_[index].label())});
    }
  }
}

void OrderedActions::finish(const Batch& batch, std::size_t index, Completed ended) {
  const Duration begin = batch.begin - started_;
  const Duration now = RealClock::instance().now() - started_;
  if (ended.span) {  // another process may report anything
    const Duration from = std::clamp(begin + ended.span->begin, begin, now);
    ended.span = Span{from, std::clamp(begin + ended.span->end, from, now)};
  } else {
    ended.span = Span{begin, now};
  }
  const bool was_ready = waits_for_[index] == 0;
  if (!ended.outcome && !was_ready) {
    ended.begun = false;
  }
  if (!ended.outcome && ended.begun && ended.outcome.error().code == ErrorCode::DeadlineExceeded) {
    timed_out_.emplace_back(index, std::move(ended));
    return;
  }
  report(index, std::move(ended));
}

void OrderedActions::report(std::size_t index, Completed ended) {
  ended.index = index;
  if (ended.took) {
    ended.took = std::min(*ended.took, ended.span->end - ended.span->begin);
  }
  progress_[index] = Progress::Reported;
  --in_progress_;
  if (ended.outcome) {
    ended.begun = true;
    release_successors(index);
  } else {
    // Nothing here has failed or was stopped, so something there has.
    ended.begun = ended.begun || (!failed_ && !cancelled_);
    failed_ = true;
  }
  undelivered_.push_back(std::move(ended));
}

void OrderedActions::release_successors(std::size_t index) {
  for (const std::size_t next : successors_[index]) {
    if (--waits_for_[next] == 0 && progress_[next] == Progress::Waiting) {
      ready_.push_back(next);
    }
  }
}

void OrderedActions::settle_doubtful() {
  auto doubtful = std::exchange(timed_out_, {});
  const model::Network observed = [&]() SEGUE_REQUIRES(mutex_) {
    const Unlocked unlocked(mutex_);
    return performer_.observe();
  }();
  for (auto& [index, ended] : doubtful) {
    if (took_effect(actions_[index], observed)) {
      ended.outcome = {};
      ended.took.reset();
    }
    report(index, std::move(ended));
  }
  begin_no_more();
  deliver();
}

void OrderedActions::cancel() {
  Lock lock(mutex_);
  cancelled_ = true;
  report_unbegun();  // whoever waits for one of them need not wait for others that are in progress
  begin_no_more();
  changed_.notify_all();
}

void OrderedActions::leave(const Leaving::MayBeLeft& may_be_left) {
  cancel();
  Lock lock(mutex_);
  for (const auto& batch : batches_) {
    for (std::size_t i = 0; i < batch->indices.size(); ++i) {
      const std::size_t index = batch->indices[i];
      if (batch->reported[i] || !may_be_left(actions_[index])) {
        continue;
      }
      batch->reported[i] = batch->left[i] = true;
      Completed left{index, fail(ErrorCode::Cancelled, "was left in progress", actions_[index].label())};
      left.span = Span{batch->begin - started_, RealClock::instance().now() - started_};
      left.begun = false;
      report(index, std::move(left));
    }
  }
  deliver();
  changed_.notify_all();
}

void OrderedActions::begin_no_more() {
  if (told_ || !performer_.begin_no_more || in_progress_ == 0 || (!failed_ && !cancelled_)) {
    return;
  }
  told_ = true;
  const Unlocked unlocked(mutex_);
  performer_.begin_no_more();
}

void OrderedActions::report_unbegun() {
  for (std::size_t index = 0; index < actions_.size(); ++index) {
    if (progress_[index] == Progress::Waiting) {
      progress_[index] = Progress::Reported;
      Completed one{index, fail(ErrorCode::Cancelled, "was not begun", actions_[index].label())};
      one.begun = false;
      if (!failed_ && !cancelled_) {
        one.outcome = fail(ErrorCode::Internal, "has to wait for itself", actions_[index].label());
        one.span = Span{};
        one.begun = true;
      }
      undelivered_.push_back(std::move(one));
    }
  }
  deliver();
}

}  // namespace segue::task_host
