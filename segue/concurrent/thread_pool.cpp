// SPDX-License-Identifier: Apache-2.0
#include <segue/concurrent/thread_pool.hpp>

#include <segue/base/log.hpp>
#include <segue/concurrent/thread.hpp>

#include <condition_variable>
#include <deque>
#include <mutex>
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
    std::unique_lock lock(mutex_);
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
    std::unique_lock lock(mutex_);
    all_done_.wait(lock, [&] { return done_ == jobs_.size(); });
  }

 private:
  const std::vector<ThreadPool::Job> jobs_;
  std::mutex mutex_;  ///< protects the counters
  std::condition_variable all_done_;
  std::size_t next_ = 0;
  std::size_t done_ = 0;
};

/// A job whose end somebody waits for until a deadline.
struct Awaited {
  std::mutex mutex;  ///< protects both flags
  std::condition_variable ended;
  bool done = false;
  bool overdue = false;
};

}  // namespace

/// Shared with the threads, which are detached: the last thing that a thread touches is its reference.
struct ThreadPool::Implementation : std::enable_shared_from_this<Implementation> {
  Implementation(const char* thread_name, Limits most) : name(thread_name), limits(most) {}

  bool enter(Job job, bool at_once);
  bool add_thread();
  void serve();
  void add_overdue(std::ptrdiff_t count) {
    const std::lock_guard lock(mutex);
    overdue += count;
  }

  const char* const name;
  const Limits limits;
  std::mutex mutex;                 ///< protects all below
  std::condition_variable changed;  ///< there is a job, or the pool is closed
  std::condition_variable left;     ///< a thread has ended
  std::deque<Job> jobs;
  std::size_t threads = 0;
  std::size_t idle = 0;
  std::ptrdiff_t overdue = 0;
  bool closed = false;
};

bool ThreadPool::Implementation::enter(Job job, bool at_once) {
  {
    const std::lock_guard lock(mutex);
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
  std::unique_lock lock(mutex);
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
      changed.wait(lock, [&] { return closed || !jobs.empty(); });
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
    const std::lock_guard lock(awaited->mutex);
    awaited->done = true;
    if (awaited->overdue) {
      pool->add_overdue(-1);
    }
    awaited->ended.notify_all();
  });
  if (!begun) {
    return fail(ErrorCode::Unavailable, "there is no thread for it");
  }
  std::unique_lock lock(awaited->mutex);
  if (!awaited->ended.wait_until(lock, deadline, [&] { return awaited->done; })) {
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
    std::unique_lock lock(implementation_->mutex);
    implementation_->closed = true;
    implementation_->changed.notify_all();
    implementation_->left.wait(lock, [&] { return implementation_->threads == 0; });
  }
  deadlines_.close();
}

}  // namespace segue::concurrent
