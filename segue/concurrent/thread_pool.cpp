// SPDX-License-Identifier: Apache-2.0
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/concurrent/thread_pool.hpp>

#include <segue/base/log.hpp>
#include <segue/concurrent/thread.hpp>

#include <deque>
#include <string>
#include <system_error>
#include <utility>

namespace segue::concurrent {

namespace {

/// The jobs of one run_all(), taken one by one by whoever has time.
class Round {
 public:
  explicit Round(std::vector<ThreadPool::Job> jobs) : jobs_(std::move(jobs)) {}

  void take_part() {
    Lock lock(mutex_);
    while (next_ < jobs_.size()) {
      const auto& mine = jobs_[next_++];
      lock.unlock();
      mine();
      lock.lock();
      if (++done_ == jobs_.size()) {
        all_done_.notify_all();
      }
    }
  }

  void wait() {
    Lock lock(mutex_);
    all_done_.wait(mutex_, [&]() SEGUE_REQUIRES(mutex_) { return done_ == jobs_.size(); });
  }

 private:
  const std::vector<ThreadPool::Job> jobs_;
  Mutex mutex_;  ///< protects the counters
  ConditionVariable all_done_;
  std::size_t next_ = 0;
  std::size_t done_ = 0;
};

/// A job whose end somebody waits for until a deadline.
struct Awaited {
  Mutex mutex;  ///< protects both flags
  ConditionVariable ended;
  bool done SEGUE_GUARDED_BY(mutex) = false;
  bool overdue = false;
};

}  // namespace

/// Shared with the threads, which are detached: the last thing that a thread touches is its reference.
struct ThreadPool::Implementation : std::enable_shared_from_this<Implementation> {
  Implementation(const char* thread_name, Limits most) : name(thread_name), limits(most) {}

  bool enter(Job job, bool at_once);
  bool add_thread() SEGUE_REQUIRES(mutex);
  void serve();
  void add_overdue(std::ptrdiff_t count) {
    const Lock lock(mutex);
    overdue += count;
  }

  const char* const name;
  const Limits limits;
  Mutex mutex;                ///< protects all below
  ConditionVariable changed;  ///< there is a job, or the pool is closed
  ConditionVariable left;     ///< a thread has ended
  std::deque<Job> jobs SEGUE_GUARDED_BY(mutex);
  std::size_t threads SEGUE_GUARDED_BY(mutex) = 0;
  std::size_t idle SEGUE_GUARDED_BY(mutex) = 0;
  std::ptrdiff_t overdue SEGUE_GUARDED_BY(mutex) = 0;
  bool closed SEGUE_GUARDED_BY(mutex) = false;
};

bool ThreadPool::Implementation::enter(Job job, bool at_once) {
  {
    const Lock lock(mutex);
    if (closed) {
      return false;
    }
    const bool all_busy = jobs.size() >= idle;
    if (all_busy && !add_thread() && (at_once || threads == 0)) {
      return false;
    }
    jobs.push_back(std::move(job));
  }
  changed.notify_one();
  return true;
}

bool ThreadPool::Implementation::add_thread() {
  if (static_cast<std::ptrdiff_t>(threads) - overdue >= static_cast<std::ptrdiff_t>(limits.threads)) {
    return false;
  }
  try {
    start_thread(name, [self = shared_from_this()] { self->serve(); }).detach();
    ++threads;
    return true;
  } catch (const std::system_error& error) {
    log(LogLevel::Error, "threads", std::string("cannot start ") + name + ": " + error.what());
    return false;
  }
}

void ThreadPool::Implementation::serve() {
  Lock lock(mutex);
  while (true) {
    if (!jobs.empty()) {
      Job job = std::move(jobs.front());
      jobs.pop_front();
      lock.unlock();
      job();
      job = nullptr;  // what it holds goes before anybody is told that it has ended
      lock.lock();
    } else if (closed || idle >= limits.idle) {
      break;
    } else {
      ++idle;
      changed.wait(mutex, [&]() SEGUE_REQUIRES(mutex) { return closed || !jobs.empty(); });
      --idle;
    }
  }
  --threads;
  left.notify_all();
}

ThreadPool::ThreadPool(const char* name, Limits limits)
    : implementation_(std::make_shared<Implementation>(name, limits)) {}

ThreadPool::~ThreadPool() {
  close();
}

bool ThreadPool::submit(Job job) {
  return implementation_->enter(std::move(job), false);
}

bool ThreadPool::try_submit(Job job) {
  return implementation_->enter(std::move(job), true);
}

void ThreadPool::run_all(std::vector<Job> jobs) {
  if (jobs.empty()) {
    return;
  }
  const std::size_t others = jobs.size() - 1;
  const auto round = std::make_shared<Round>(std::move(jobs));
  for (std::size_t i = 0; i < others; ++i) {
    submit([round] { round->take_part(); });
  }
  round->take_part();
  round->wait();
}

Result<void> ThreadPool::run(Job job, TimePoint deadline) {
  const auto awaited = std::make_shared<Awaited>();
  const bool begun = submit([awaited, job = std::move(job), pool = implementation_]() mutable {
    job();
    job = nullptr;
    const Lock lock(awaited->mutex);
    awaited->done = true;
    if (awaited->overdue) {
      pool->add_overdue(-1);
    }
    awaited->ended.notify_all();
  });
  if (!begun) {
    return fail(ErrorCode::Unavailable, "there is no thread for it");
  }
  Lock lock(awaited->mutex);
  if (!awaited->ended.wait_until(awaited->mutex, deadline,
                                 [&]() SEGUE_REQUIRES(awaited->mutex) { return awaited->done; })) {
    awaited->overdue = true;
    add_overdue(1);
    return fail(ErrorCode::DeadlineExceeded,
                "has not ended by its deadline; it may still be at work, so look at the true state");
  }
  return {};
}

void ThreadPool::add_overdue(std::ptrdiff_t threads) {
  implementation_->add_overdue(threads);
}

void ThreadPool::close() {
  {
    Lock lock(implementation_->mutex);
    implementation_->closed = true;
    implementation_->changed.notify_all();
    implementation_->left.wait(implementation_->mutex, [&]() SEGUE_REQUIRES(implementation_->mutex) {
      return implementation_->threads == 0;
    });
  }
  deadlines_.close();
}

}  // namespace segue::concurrent
