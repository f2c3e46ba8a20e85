// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace segue::control::detail {

/// Threads for calls that may block: made when needed, kept for the next call, never more than `limit`.
/// A job begins at once or is refused, so one slow job never delays another. Thread safe.
class WorkerPool {
 public:
  using Job = std::function<void()>;

  explicit WorkerPool(std::size_t limit) : limit_(limit) {}
  /// finish().
  ~WorkerPool() { finish(); }
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// False where `limit` jobs are in progress, no thread can be made, or after finish(). Jobs must not throw.
  bool submit(Job job);
  /// Waits for the jobs in progress and ends all threads. Only once from one thread.
  void finish();

 private:
  void work();
  bool add_thread();

  const std::size_t limit_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> jobs_;
  std::size_t busy_ = 0;  ///< jobs waiting for their thread or in progress
  bool finished_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace segue::control::detail
