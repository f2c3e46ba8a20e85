// SPDX-License-Identifier: Apache-2.0
#include <segue/task/run_queue.hpp>

namespace segue::task::detail {

bool RunQueue::post(Job& job, std::uint32_t reason, TimePoint now) noexcept {
  if ((job.flags_.fetch_or(Job::kQueued | reason, std::memory_order_acq_rel) & Job::kQueued) != 0)
    return false;
  job.wanted_since_ = now;
  Job* head = posted_.load(std::memory_order_relaxed);
  do {
    job.next_ = head;
  } while (!posted_.compare_exchange_weak(head, &job, std::memory_order_seq_cst, std::memory_order_relaxed));
  return true;
}

void RunQueue::post_here(Job& job, std::uint32_t reason, TimePoint now) noexcept {
  if ((job.flags_.fetch_or(Job::kQueued | reason, std::memory_order_acq_rel) & Job::kQueued) != 0) return;
  job.wanted_since_ = now;
  append(&job);
}

void RunQueue::append(Job* job) noexcept {
  job->next_ = nullptr;
  (last_ == nullptr ? first_ : last_->next_) = job;
  last_ = job;
}

void RunQueue::fetch() noexcept {
  if (posted_.load(std::memory_order_relaxed) == nullptr) return;
  Job* newest = posted_.exchange(nullptr, std::memory_order_acquire);
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

bool RunQueue::run_one(TimePoint& now) noexcept {
  fetch();
  Job* job = first_;
  if (job == nullptr) return false;
  first_ = job->next_;
  if (first_ == nullptr) last_ = nullptr;
  job->running_since_ = job->wanted_since_;
  // From here on others may queue the job again.
  const std::uint32_t flags = job->flags_.exchange(0, std::memory_order_acq_rel);
  if ((flags & Job::kRetire) != 0) {
    clear_timer(*job);
    job->retired_.store(1, std::memory_order_release);
    // The job may be destroyed by now; the system only uses the address, so a wake that nobody waits for is
    // harmless.
    futex_wake(job->retired_, 1);
    return true;
  }
  const TimePoint due = job->run(flags & Job::kAllReasons, now);
  if (due == kNever) {
    clear_timer(*job);
  } else {
    set_timer(*job, due);
  }
  return true;
}

void RunQueue::fire(TimePoint now) noexcept {
  while (!timers_.empty() && timers_.front()->due_ <= now) {
    Job& job = *timers_.front();
    const TimePoint due = job.due_;
    clear_timer(job);
    post_here(job, Job::kTimer, due);
  }
}

bool RunQueue::post_retire(Job& job) noexcept {
  return post(job, Job::kRetire, TimePoint{});
}

void RunQueue::wait_retired(Job& job) noexcept {
  while (job.retired_.load(std::memory_order_acquire) == 0)
    futex_wait(job.retired_, 0, kNever);
}

void RunQueue::forget(Job& job) noexcept {
  fetch();
  clear_timer(job);
  Job* ready = first_;
  first_ = last_ = nullptr;
  while (ready != nullptr) {
    Job* next = ready->next_;
    if (ready != &job) append(ready);
    ready = next;
  }
}

void RunQueue::place(Job* job, std::size_t position) noexcept {
  timers_[position] = job;
  job->timer_ = position;
}

void RunQueue::set_timer(Job& job, TimePoint due) noexcept {
  job.due_ = due;
  if (job.timer_ == Job::kNoTimer) {
    timers_.push_back(&job);
    job.timer_ = timers_.size() - 1;
  }
  sift_up(job.timer_);
  sift_down(job.timer_);
}

void RunQueue::clear_timer(Job& job) noexcept {
  if (job.timer_ == Job::kNoTimer) return;
  const std::size_t position = job.timer_;
  Job* moved = timers_.back();
  timers_.pop_back();
  job.timer_ = Job::kNoTimer;
  if (moved == &job) return;
  place(moved, position);
  sift_up(position);
  sift_down(moved->timer_);
}

void RunQueue::sift_up(std::size_t position) noexcept {
  while (position > 0) {
    const std::size_t parent = (position - 1) / 2;
    if (timers_[parent]->due_ <= timers_[position]->due_) return;
    Job* lower = timers_[position];
    place(timers_[parent], position);
    place(lower, parent);
    position = parent;
  }
}

void RunQueue::sift_down(std::size_t position) noexcept {
  while (true) {
    std::size_t child = 2 * position + 1;
    if (child >= timers_.size()) return;
    if (child + 1 < timers_.size() && timers_[child + 1]->due_ < timers_[child]->due_) ++child;
    if (timers_[position]->due_ <= timers_[child]->due_) return;
    Job* upper = timers_[position];
    place(timers_[child], position);
    place(upper, child);
    position = child;
  }
}

}  // namespace segue::task::detail
