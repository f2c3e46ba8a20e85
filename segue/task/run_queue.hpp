// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task/executor.hpp>

#include <atomic>
#include <vector>

namespace segue::task::detail {

/// What is ready to run, and what will be at a given time. Any thread may post(); everything else belongs to
/// the thread that runs the jobs. Nothing but make_room() allocates.
class RunQueue {
 public:
  /// Puts the job in unless it is in already. True: it was not, and the runner may have to be woken.
  bool post(Job& job, std::uint32_t reason, TimePoint now) noexcept;
  /// The same from the runner's thread, without telling other processors.
  void post_here(Job& job, std::uint32_t reason, TimePoint now) noexcept;
  [[nodiscard]] bool has_posted() const noexcept {
    return posted_.load(std::memory_order_seq_cst) != nullptr;
  }

  /// Runs the longest ready job, if any, and sets its timer by its answer.
  bool run_one(TimePoint& now) noexcept;
  /// Makes the jobs ready whose time has come.
  void fire(TimePoint now) noexcept;
  [[nodiscard]] TimePoint next_due() const noexcept {
    return timers_.empty() ? kNever : timers_.front()->due_;
  }

  /// From any thread: the runner will forget the job. Then wait_retired() tells when it has.
  bool post_retire(Job& job) noexcept;
  static void wait_retired(Job& job) noexcept;
  /// From the runner's thread: forgets it at once.
  void forget(Job& job) noexcept;

  /// Room for timers of so many jobs. From the runner's thread, or before it runs.
  void make_room(std::size_t jobs) { timers_.reserve(jobs); }
  [[nodiscard]] std::size_t room() const { return timers_.capacity(); }

 private:
  void fetch() noexcept;
  void append(Job* job) noexcept;
  void set_timer(Job& job, TimePoint due) noexcept;
  void clear_timer(Job& job) noexcept;
  void sift_up(std::size_t position) noexcept;
  void sift_down(std::size_t position) noexcept;
  void place(Job* job, std::size_t position) noexcept;

  Job* first_ = nullptr;  ///< ready jobs in order
  Job* last_ = nullptr;
  std::vector<Job*> timers_;                       ///< binary heap by due time
  alignas(64) std::atomic<Job*> posted_{nullptr};  ///< a stack, newest first
};

}  // namespace segue::task::detail
