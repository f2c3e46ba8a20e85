// SPDX-License-Identifier: Apache-2.0
#include <segue/task/run_queue.hpp>

namespace segue::task::detail {

[[gnu::hot]] bool RunQueue::post(Job& job, std::uint32_t reason, TimePoint now) noexcept {
  if ((job.flags_.fetch_or(Job::kQueued | reason, std::memory_order_acq_rel) & Job::kQueued) != 0)  // Q1
    return false;
  job.wanted_since_ = now;
  Job* head = posted_.load(std::memory_order_relaxed);
  do {
    job.next_ = head;
    // Q2: publishes next_ and wanted_since_. Q3: before the poster loads whether the runner sleeps.
  } while (!posted_.compare_exchange_weak(head, &job, std::memory_order_seq_cst, std::memory_order_relaxed));
  return true;
}

[[gnu::hot]] void RunQueue::post_here(Job& job, std::uint32_t reason, TimePoint now) noexcept {
  // Q1: as in post().
  if ((job.flags_.fetch_or(Job::kQueued | reason, std::memory_order_acq_rel) & Job::kQueued) != 0) return;
  job.wanted_since_ = now;
  append(&job);
}

[[gnu::hot]] void RunQueue::append(Job* job) noexcept {
  job->next_ = nullptr;
  (last_ == nullptr ? first_ : last_->next_) = job;
  last_ = job;
}

[[gnu::hot]] void RunQueue::fetch() noexcept {
  // Relaxed: saves the exchange, and decides nothing.
  if (posted_.load(std::memory_order_relaxed) == nullptr) return;
  Job* newest = posted_.exchange(nullptr, std::memory_order_acquire);  // pairs with Q2
  Job* oldest = nullptr;
  while (newest != nullptr) {
    Job* next = newest->next_;
    newest->next_ = oldest;
    oldest = newest;
    newest = next;
  }
  while (oldest != nullptr) {
    Job* next = oldest->next_;
    append(oldest);
    oldest = next;
  }
}

[[gnu::hot]] bool RunQueue::run_one(TimePoint& now) noexcept {
  fetch();
  Job* job = first_;
  if (job == nullptr) return false;
  first_ = job->next_;
  if (first_ == nullptr) last_ = nullptr;
  job->running_since_ = job->wanted_since_;
  // From here on others may queue the job again.
  const std::uint32_t flags = job->flags_.exchange(0, std::memory_order_acq_rel);  // Q1: as in post().
  if ((flags & Job::kRetire) != 0) {
    timers_.clear(*job);
    job->retired_.store(1, std::memory_order_release);  // Q4
    // The job may be destroyed by now; the system only uses the address, so a wake that nobody waits for is
    // harmless.
    futex_wake(job->retired_, 1);
    return true;
  }
  const TimePoint due = job->run(flags & Job::kAllReasons, now);
  if (due == kNever) {
    timers_.clear(*job);
  } else {
    timers_.set(*job, due);
  }
  return true;
}

[[gnu::hot]] void RunQueue::fire(TimePoint now) noexcept {
  while (timers_.next_due() <= now) {
    Job& job = static_cast<Job&>(*timers_.first());
    timers_.clear(job);
    post_here(job, Job::kTimer, job.due());
  }
}

bool RunQueue::post_retire(Job& job) noexcept {
  return post(job, Job::kRetire, TimePoint{});
}

void RunQueue::wait_retired(Job& job) noexcept {
  while (job.retired_.load(std::memory_order_acquire) == 0)  // pairs with Q4
    futex_wait(job.retired_, 0, kNever);
}

void RunQueue::forget(Job& job) noexcept {
  fetch();
  timers_.clear(job);
  Job* ready = first_;
  first_ = last_ = nullptr;
  while (ready != nullptr) {
    Job* next = ready->next_;
    if (ready != &job) append(ready);
    ready = next;
  }
}

}  // namespace segue::task::detail
