// SPDX-License-Identifier: Apache-2.0
#include <segue/control/detail/worker_pool.hpp>

#include <pthread.h>

#include <csignal>
#include <system_error>
#include <utility>

namespace segue::control::detail {

bool WorkerPool::submit(Job job) {
  const std::lock_guard lock(mutex_);
  if (finished_ || busy_ >= limit_) return false;
  if (busy_ == threads_.size() && !add_thread()) return false;
  ++busy_;
  jobs_.push_back(std::move(job));
  changed_.notify_one();
  return true;
}

bool WorkerPool::add_thread() {
  try {
    threads_.emplace_back([this] { work(); });
    return true;
  } catch (const std::system_error&) {
    return false;
  }
}

void WorkerPool::work() {
  sigset_t all;  // signals are for the main thread
  sigfillset(&all);
  for (const int fault : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT})
    sigdelset(&all, fault);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
  pthread_setname_np(pthread_self(), "segue-worker");

  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return finished_ || !jobs_.empty(); });
    if (jobs_.empty()) return;
    Job job = std::move(jobs_.front());
    jobs_.pop_front();
    lock.unlock();
    job();
    job = nullptr;
    lock.lock();
    --busy_;
  }
}

void WorkerPool::finish() {
  std::vector<std::thread> threads;
  {
    const std::lock_guard lock(mutex_);
    finished_ = true;
    threads.swap(threads_);
  }
  changed_.notify_all();
  for (std::thread& thread : threads)
    thread.join();
}

}  // namespace segue::control::detail
