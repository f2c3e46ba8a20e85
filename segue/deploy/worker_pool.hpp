// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace segue::deploy::detail {

/// Threads for calls that may block until their deadlines: a first few, and more where all of them are busy,
/// up to a limit; what is beyond it waits. All functions may be called from any thread.
class WorkerPool {
 public:
  using Job = std::function<void()>;

  WorkerPool(std::size_t first, std::size_t most);
  ~WorkerPool() { close(); }
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// Carried out soon on a thread of the pool. False after close(): it never will be.
  bool submit(Job job);
  /// Carries out all side by side and returns when all are done. The caller's thread takes part, so this
  /// works from inside a job, beyond the limit and after close() too.
  void run_all(std::vector<Job> jobs);
  /// Waits for jobs under way; those that wait are dropped.
  void close();

 private:
  void work();

  const std::size_t most_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> waiting_;
  std::vector<std::thread> threads_;
  std::size_t busy_ = 0;
  bool closed_ = false;
};

}  // namespace segue::deploy::detail
