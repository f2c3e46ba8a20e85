// SPDX-License-Identifier: Apache-2.0
#include <segue/deploy/worker_pool.hpp>

#include <pthread.h>

#include <memory>
#include <utility>

namespace segue::deploy::detail {

namespace {

/// Jobs of one run_all(), taken one by one by whoever has time.
class Round {
 public:
  explicit Round(std::vector<WorkerPool::Job> jobs) : jobs_(std::move(jobs)) {}

  void take_part() {
    while (true) {
      std::size_t mine = 0;
      {
        const std::lock_guard lock(mutex_);
        if (next_ == jobs_.size()) {
          return;
        }
        mine = next_++;
      }
      jobs_[mine]();
      const std::lock_guard lock(mutex_);
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
  std::vector<WorkerPool::Job> jobs_;
  std::mutex mutex_;
  std::condition_variable all_done_;
  std::size_t next_ = 0;
  std::size_t done_ = 0;
};

}  // namespace

WorkerPool::WorkerPool(std::size_t first, std::size_t most) : most_(most) {
  for (std::size_t i = 0; i < first; ++i) {
    threads_.emplace_back([this] { work(); });
  }
}

bool WorkerPool::submit(Job job) {
  {
    const std::lock_guard lock(mutex_);
    if (closed_) {
      return false;
    }
    waiting_.push_back(std::move(job));
    if (waiting_.size() + busy_ > threads_.size() && threads_.size() < most_) {
      threads_.emplace_back([this] { work(); });
    }
  }
  changed_.notify_one();
  return true;
}

void WorkerPool::run_all(std::vector<Job> jobs) {
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

void WorkerPool::close() {
  std::vector<std::thread> threads;
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    waiting_.clear();
    threads.swap(threads_);
  }
  changed_.notify_all();
  for (auto& thread : threads) {
    thread.join();
  }
}

void WorkerPool::work() {
  ::pthread_setname_np(::pthread_self(), "segue-worker");
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return closed_ || !waiting_.empty(); });
    if (closed_) {
      return;
    }
    const Job job = std::move(waiting_.front());
    waiting_.pop_front();
    ++busy_;
    lock.unlock();
    job();
    lock.lock();
    --busy_;
  }
}

}  // namespace segue::deploy::detail
