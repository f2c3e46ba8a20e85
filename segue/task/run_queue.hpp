// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task/executor.hpp>

#include <atomic>

namespace segue::task::detail {

/// The jobs that are ready to run, and those that will be at a given time. Any thread may post(); everything
/// else is for the thread that runs the jobs (the runner). Nothing allocates.
///
/// Memory order:
/// - Q1: whoever sets kQueued in Job::flags_ (acquire-release) alone writes the job's next_ and
///   wanted_since_. The runner reads both before it clears flags_ (acquire-release), so the next poster
///   writes them afterwards. A poster that finds kQueued set relies on the runner's exchange of flags_, too:
///   its reason and all that it wrote before are seen by the run.
/// - Q2: post() pushes the job to the stack posted_; the runner takes the whole stack with an acquiring
///   exchange.
/// - Q3: the push to posted_ and the load in has_posted() are sequentially consistent, because executors
///   combine them with the word that says whether they sleep: a poster pushes and then loads that word, the
///   runner stores it and then checks has_posted() (E1 in thread_executor.cpp).
/// - Q4: the runner releases Job::retired_ after its last access to the job; wait_retired() acquires it.
class RunQueue {
 public:
  /// Queues the job unless it is queued already. True: it was not, so the runner may have to be woken.
  bool post(Job& job, std::uint32_t reason, TimePoint now) noexcept;
  /// For the runner: queues the job like post(), but without the shared stack.
  void post_here(Job& job, std::uint32_t reason, TimePoint now) noexcept;
  [[nodiscard]] bool has_posted() const noexcept {
    return posted_.load(std::memory_order_seq_cst) != nullptr;  // Q3
  }

  /// For the runner: whether run_one() would run a job that it has already fetched or queued itself.
  [[nodiscard]] bool has_ready() const noexcept { return first_ != nullptr; }

  /// Runs the job that has been ready longest, if any, and sets its timer as it returns. False: none was
  /// ready.
  bool run_one(TimePoint& now) noexcept;
  /// Queues the jobs whose time has come.
  void fire(TimePoint now) noexcept;
  [[nodiscard]] TimePoint next_due() const noexcept { return timers_.next_due(); }

  /// Asks the runner to forget the job; wait_retired() waits until it has. From any thread. True: the runner
  /// may have to be woken.
  bool post_retire(Job& job) noexcept;
  static void wait_retired(Job& job) noexcept;
  /// Forgets the job at once. From the runner's thread.
  void forget(Job& job) noexcept;

 private:
  void fetch() noexcept;
  void append(Job* job) noexcept;

  Job* first_ = nullptr;  ///< ready jobs, oldest first
  Job* last_ = nullptr;
  TimerHeap timers_;
  alignas(64) std::atomic<Job*> posted_{nullptr};  ///< a stack, newest first
};

}  // namespace segue::task::detail
