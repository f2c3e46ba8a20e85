// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/concurrent/deadline_watch.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace segue::concurrent {

/// Threads for work that may block. They are started when they are needed; some of those that have nothing to
/// do are kept. All functions may be called from any thread.
class ThreadPool {
 public:
  /// Must not throw.
  using Job = std::function<void()>;

  static constexpr std::size_t kNoLimit = PTRDIFF_MAX;
  struct Limits {
    std::size_t threads = 64;  ///< at work at the same time, those with overdue work aside
    std::size_t idle = 4;      ///< kept although they have nothing to do
  };

  /// `name` is that of its threads: a literal of at most 15 characters.
  ThreadPool(const char* name, Limits limits);
  /// close().
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  /// Runs a job as soon as a thread is free; does not block. False after close(), or where there is no thread
  /// and none can be made: the job is dropped.
  bool submit(Job job);
  /// Runs a job like submit(), but is false, too, where the job would have to wait for another one to end.
  bool try_submit(Job job);
  /// Runs all jobs at the same time and returns when all have ended. The caller's thread takes part, so this
  /// works inside a job, beyond the limit and after close() too.
  void run_all(std::vector<Job> jobs);
  /// Runs a job and waits for its end. DeadlineExceeded where it has not ended by then: it keeps its thread,
  /// which another one replaces, so it must own what it uses. Unavailable where it cannot be run.
  Result<void> run(Job job, TimePoint deadline);

  /// Work on this many of the threads is overdue (negative: has ended after all). They do not count against
  /// the limit.
  void add_overdue(std::ptrdiff_t threads);
  /// Calls back when work of this pool is due; ends with the pool.
  [[nodiscard]] DeadlineWatch& deadlines() { return deadlines_; }

  /// Waits for all jobs that were submitted, overdue ones too, and ends all threads. Not inside a job.
  void close();

 private:
  struct Implementation;
  const std::shared_ptr<Implementation> implementation_;
  DeadlineWatch deadlines_;
};

}  // namespace segue::concurrent
