// SPDX-License-Identifier: Apache-2.0
#include <segue/task_host/watches.hpp>

#include <segue/concurrent/thread.hpp>
#include <segue/task/futex.hpp>

#include <algorithm>
#include <utility>

namespace segue::task_host::detail {

Watches::Open::Open(Wait until, Poll how, Watches& owner)
    : wait(std::move(until)), poll(std::move(how)), stopped(wait.stop, [&owner] { owner.wake(); }) {}

void Watches::add(Wait wait, Poll poll) {
  if (poll(End::No)) return;
  Lock lock(mutex_);
  if (closed_) {
    lock.unlock();
    poll(End::Closed);
    return;
  }
  if (!thread_) thread_ = concurrent::start_thread(thread_name_, [this] { run(); });
  open_count_.fetch_add(1, std::memory_order_seq_cst);  // W1
  added_.push_back(std::make_unique<Open>(std::move(wait), std::move(poll), *this));
  lock.unlock();
  wake();
}

void Watches::ring() noexcept {
  std::atomic_thread_fence(std::memory_order_seq_cst);
  if (open_count_.load(std::memory_order_seq_cst) > 0) wake();  // W1: after the change and the fence
}

void Watches::wake() noexcept {
  rings_.fetch_add(1, std::memory_order_seq_cst);  // W2
  task::detail::futex_wake(rings_, 1);
}

void Watches::close() {
  std::optional<std::thread> thread;
  {
    const Lock lock(mutex_);
    closed_ = true;
    thread = std::exchange(thread_, std::nullopt);
  }
  wake();
  if (thread) thread->join();
}

void Watches::run() {
  while (true) {
    const std::uint32_t seen = rings_.load(std::memory_order_seq_cst);  // W2
    bool is_last = false;
    {
      const Lock lock(mutex_);
      open_.splice(open_.end(), added_);
      is_last = closed_;
    }
    const TimePoint next = look_at_all(RealClock::instance().now());
    if (is_last) return;
    task::detail::futex_wait(rings_, seen, next);
  }
}

Watches::End Watches::end_of(const Open& open, TimePoint now) const {
  if (closed_) return End::Closed;
  if (open.wait.is_stopped()) return End::Stop;
  return now >= open.wait.deadline ? End::Deadline : End::No;
}

TimePoint Watches::look_at_all(TimePoint now) {
  TimePoint next = task::detail::kNever;
  for (auto one = open_.begin(); one != open_.end();) {
    if ((*one)->poll(end_of(**one, now))) {
      one = open_.erase(one);
      open_count_.fetch_sub(1, std::memory_order_seq_cst);
    } else {
      next = std::min({next, now + period_, (*one)->wait.deadline});
      ++one;
    }
  }
  return next;
}

}  // namespace segue::task_host::detail
