// SPDX-License-Identifier: Apache-2.0
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/task_host/action_pool.hpp>

#include <segue/task_host/batch_outcomes.hpp>

#include <algorithm>
#include <atomic>
#include <exception>
#include <functional>
#include <string>
#include <utility>

namespace segue::task_host {

namespace {

/// Actions keep their deadlines by themselves, and say more about it than the pool can.
constexpr Duration kGrace = std::chrono::milliseconds(10);

TimePoint end_of(TimePoint deadline) {
  return deadline > TimePoint::max() - kGrace ? deadline : deadline + kGrace;
}

Error overdue(bool begun) {
  return fail(ErrorCode::DeadlineExceeded,
              begun ? "has not ended by its deadline; it may still be at work, so look at the true state"
                    : "was not begun by its deadline, since too many others are at work");
}

}  // namespace

struct ActionPool::Implementation : std::enable_shared_from_this<Implementation> {
  class Batch;
  using BatchPtr = std::shared_ptr<Batch>;

  Implementation(concurrent::ThreadPool& pool, Work carry_out, Duration longest)
      : threads(pool), work(std::move(carry_out)), patience(longest) {}

  /// Counts a worker of the batch; false after close().
  bool enter(Batch& batch, bool called);
  void watch(const BatchPtr& batch, bool alone);
  void begin(const BatchPtr& batch);
  void begin_here(const BatchPtr& batch);
  /// Makes one more thread work on the batch, unless one is on its way already.
  void call_worker(const BatchPtr& batch);
  /// Carries out actions of the batch in a worker's thread, once the worker has been counted.
  void work_on(BatchPtr batch);
  void leave(const BatchPtr& batch);
  /// Reports on another thread than the one that watches deadlines: reports may begin batches.
  void report(std::function<void()> how);
  void close();

  /// Batches that are begun while this thread reports the end of one of this pool; it carries them out
  /// itself.
  struct FollowUps {
    const Implementation* pool;
    std::vector<BatchPtr> batches;
  };
  static thread_local FollowUps* follow_ups;

  concurrent::ThreadPool& threads;
  const Work work;
  const Duration patience;
  Mutex mutex;  ///< protects all below, and the workers of all batches
  ConditionVariable left;
  std::size_t workers SEGUE_GUARDED_BY(mutex) = 0;  ///< of all batches
  bool is_closed SEGUE_GUARDED_BY(mutex) = false;
};

thread_local ActionPool::Implementation::FollowUps* ActionPool::Implementation::follow_ups = nullptr;

/// Workers take the actions by a counter. Its order needs to say nothing of other memory: the actions have
/// not changed since the batch was handed over under a lock, and outcomes are protected by a lock of their
/// own.
class ActionPool::Implementation::Batch final : public concurrent::DeadlineWatch::Entry,
                                                public std::enable_shared_from_this<Batch> {
 public:
  Batch(std::shared_ptr<ActionPool::Implementation> pool, std::vector<model::Action> all, TimePoint until,
        Completion completed)
      : pool_(std::move(pool)), deadline_(until), outcomes_(std::move(all), std::move(completed)) {}

  [[nodiscard]] std::size_t size() const { return outcomes_.actions().size(); }
  [[nodiscard]] TimePoint end() const { return end_of(deadline_); }
  [[nodiscard]] bool has_ended() const { return outcomes_.ended() == size(); }
  /// Carries out actions that nobody has begun. `follow_ups` gets the batches that are begun by reports.
  void take_part(FollowUps* follow_ups);
  void refuse(ErrorCode code, const std::string& why);
  TimePoint on_due(TimePoint time) override;

  // Protected by the pool's mutex.
  std::size_t workers = 0;
  bool is_called = false;   ///< a worker is on its way
  bool is_overdue = false;  ///< its workers do not count against the pool's limit

 private:
  [[nodiscard]] bool all_begun() const { return next_.load() >= size(); }
  Result<void> carry_out(const model::Action& action) const;
  void give_up();

  /// Deadlines may look after a batch that has just ended, when nobody else has the pool any more.
  const std::shared_ptr<ActionPool::Implementation> pool_;
  const TimePoint deadline_;
  BatchOutcomes outcomes_;
  std::atomic<std::size_t> next_{0};  ///< the first that nobody has begun
  /// One has delayed others: outcomes are reported at once. Set before on_due() reports. Outcomes have a lock
  /// of their own, so an outcome that comes too late for that report finds it set, and its worker reports.
  std::atomic<bool> slow_{false};
  std::size_t seen_ = 0;  ///< how many had ended at the last on_due(), which alone uses it
};

Result<void> ActionPool::Implementation::Batch::carry_out(const model::Action& action) const {
  try {
    return pool_->work(action, deadline_);
  } catch (const std::exception& exception) {
    return fail(ErrorCode::Internal, std::string("threw: ") + exception.what());
  } catch (...) {
    return fail(ErrorCode::Internal, "threw");
  }
}

void ActionPool::Implementation::Batch::take_part(FollowUps* list) {
  std::size_t index = 0;
  while ((index = next_.fetch_add(1)) < size()) {
    const TimePoint begin = monotonic_now();
    auto outcome = carry_out(outcomes_.actions()[index]);
    // A worker only reports when there is nothing left to begin, so it is free for batches that its reports
    // begin.
    auto* const before = std::exchange(follow_ups, list);
    outcomes_.note({index, std::move(outcome), monotonic_now() - begin});
    if (slow_ && all_begun()) {
      outcomes_.report();
    }
    follow_ups = before;
  }
}

void ActionPool::Implementation::Batch::refuse(ErrorCode code, const std::string& why) {
  outcomes_.fail_rest(fail(code, why));
}

TimePoint ActionPool::Implementation::Batch::on_due(TimePoint time) {
  const std::size_t done = outcomes_.ended();
  if (done == size()) {
    return TimePoint::max();
  }
  if (time >= end()) {
    give_up();
    return TimePoint::max();
  }
  const bool stuck = done == std::exchange(seen_, done);
  if (stuck) {
    slow_ = true;
  }
  // Asked before the report: an action that ends after this is reported by its worker, one that ended before
  // by this thread.
  const bool workers_report = slow_ && all_begun();
  if (slow_) {
    pool_->report([self = shared_from_this()] { self->outcomes_.report(); });
  }
  if (stuck && !all_begun()) {
    pool_->call_worker(shared_from_this());
  }
  return workers_report ? end() : std::min(time + pool_->patience, end());
}

void ActionPool::Implementation::Batch::give_up() {
  const std::size_t begun = next_.exchange(size());
  {
    const Lock lock(pool_->mutex);
    is_overdue = true;
    pool_->threads.add_overdue(static_cast<std::ptrdiff_t>(workers));
  }
  pool_->report([self = shared_from_this(), begun] {
    self->outcomes_.fail_rest([&](std::size_t index) { return overdue(index < begun); });
  });
}

bool ActionPool::Implementation::enter(Batch& batch, bool called) {
  const Lock lock(mutex);
  if (is_closed) {
    return false;
  }
  ++workers;
  ++batch.workers;
  batch.is_called = called;
  return true;
}

void ActionPool::Implementation::watch(const BatchPtr& batch, bool alone) {
  threads.deadlines().add(batch, alone ? batch->end() : std::min(monotonic_now() + patience, batch->end()));
}

void ActionPool::Implementation::begin(const BatchPtr& batch) {
  const bool follows = follow_ups != nullptr && follow_ups->pool == this;
  if (!enter(*batch, !follows)) {
    return batch->refuse(ErrorCode::Unavailable, "nothing is begun any more: this is going down");
  }
  // A single action delays no other, unless it waits for this thread.
  watch(batch, batch->size() == 1 && !follows);
  if (follows) {
    return follow_ups->batches.push_back(batch);
  }
  if (!threads.submit([self = shared_from_this(), batch] { self->work_on(batch); })) {
    leave(batch);
    batch->refuse(ErrorCode::ResourceExhausted, "no thread can be made for it");
  }
}

void ActionPool::Implementation::begin_here(const BatchPtr& batch) {
  if (!enter(*batch, false)) {
    return batch->refuse(ErrorCode::Unavailable, "nothing is begun any more: this is going down");
  }
  watch(batch, batch->size() == 1);
  batch->take_part(nullptr);
  leave(batch);
}

void ActionPool::Implementation::call_worker(const BatchPtr& batch) {
  {
    const Lock lock(mutex);
    if (batch->is_called || batch->is_overdue) {
      return;
    }
    batch->is_called = true;
    ++workers;
    ++batch->workers;
  }
  if (!threads.submit([self = shared_from_this(), batch] { self->work_on(batch); })) {
    leave(batch);  // the rest is begun when one of those that are at it returns
  }
}

void ActionPool::Implementation::work_on(BatchPtr batch) {
  FollowUps next{this, {}};
  while (batch != nullptr) {
    {
      const Lock lock(mutex);
      batch->is_called = false;
    }
    batch->take_part(&next);
    leave(batch);
    batch = nullptr;
    while (next.batches.size() > 1) {
      call_worker(next.batches.back());
      leave(next.batches.back());
      next.batches.pop_back();
    }
    if (!next.batches.empty()) {
      batch = std::move(next.batches.back());
      next.batches.clear();
    }
  }
}

void ActionPool::Implementation::leave(const BatchPtr& batch) {
  if (batch->has_ended()) {
    threads.deadlines().remove(batch);
  }
  const Lock lock(mutex);
  --batch->workers;
  if (batch->is_overdue) {
    threads.add_overdue(-1);
  }
  if (--workers == 0) {
    left.notify_all();
  }
}

void ActionPool::Implementation::report(std::function<void()> how) {
  {
    const Lock lock(mutex);
    if (is_closed && workers == 0) {
      return;  // all has ended, and has been reported
    }
    ++workers;
  }
  const auto job = [self = shared_from_this(), how = std::move(how)] {
    how();
    const Lock lock(self->mutex);
    if (--self->workers == 0) {
      self->left.notify_all();
    }
  };
  if (!threads.submit(job)) {
    job();
  }
}

void ActionPool::Implementation::close() {
  Lock lock(mutex);
  is_closed = true;
  left.wait(mutex, [&]() SEGUE_REQUIRES(mutex) { return workers == 0; });
}

ActionPool::ActionPool(concurrent::ThreadPool& threads, Work work, Duration patience)
    : implementation_(std::make_shared<Implementation>(threads, std::move(work), patience)) {}

ActionPool::~ActionPool() {
  close();
}

void ActionPool::begin(std::vector<model::Action> actions, TimePoint deadline, Completion completed) {
  if (!actions.empty()) {
    implementation_->begin(std::make_shared<Implementation::Batch>(implementation_, std::move(actions),
                                                                   deadline, std::move(completed)));
  }
}

void ActionPool::begin_here(std::vector<model::Action> actions, TimePoint deadline, Completion completed) {
  if (!actions.empty()) {
    implementation_->begin_here(std::make_shared<Implementation::Batch>(implementation_, std::move(actions),
                                                                        deadline, std::move(completed)));
  }
}

void ActionPool::close() {
  implementation_->close();
}

}  // namespace segue::task_host
