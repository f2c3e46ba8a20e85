// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/concurrent/thread_pool.hpp>
#include <segue/model/action_times.hpp>
#include <segue/task_host/task_host.hpp>

#include <functional>
#include <memory>
#include <vector>

namespace segue::task_host {

/// For pools that carry out actions: each hook that hangs keeps a thread.
inline constexpr concurrent::ThreadPool::Limits kActionThreads{256, 4};

/// Carries out batches of actions whose hooks may take long or never return, on the threads of a pool. A
/// batch runs on one thread, one action after the other; only where an action takes longer than `patience`
/// does another thread go on with the rest, and what has ended is reported. So a quick batch costs one
/// hand-over between threads and one report, and a slow action delays no other. A batch that is begun by the
/// completion of another one runs on the same thread, without any hand-over. All functions may be called from
/// any thread.
class ActionPool {
 public:
  /// Carries out one action. An exception counts as its failure.
  using Work = std::function<Result<void>(const model::Action& action, TimePoint deadline)>;

  /// `threads` must outlive this.
  ActionPool(concurrent::ThreadPool& threads, Work work, Duration patience = model::kQuickAction);
  /// close().
  ~ActionPool();
  ActionPool(const ActionPool&) = delete;
  ActionPool& operator=(const ActionPool&) = delete;

  /// Begins a batch and returns at once. Each action is reported exactly once: where it has not ended shortly
  /// after `deadline` as DeadlineExceeded; its thread is then replaced, and how it ends is not reported.
  void begin(std::vector<model::Action> actions, TimePoint deadline, Completion completed);
  /// Begins a batch that the caller's thread carries out itself, without any hand-over where all actions are
  /// quick. For actions without hooks, since it returns when the last action of the caller's thread has
  /// ended. Reports like begin().
  void begin_here(std::vector<model::Action> actions, TimePoint deadline, Completion completed);

  /// Waits for all actions in progress, overdue ones too. Batches that are begun later fail as Unavailable.
  void close();

 private:
  struct Implementation;
  std::shared_ptr<Implementation> implementation_;
};

}  // namespace segue::task_host
