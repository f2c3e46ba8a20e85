// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/task/task.hpp>

#include <atomic>
#include <list>
#include <memory>
#include <thread>

namespace segue::task_host::detail {

/// Destroys tasks that have been removed. A task whose update, operation or hook does not return can only be
/// destroyed when it does: it is kept here, with a thread of its own, so that nobody else waits for it.
/// Thread safe.
class AbandonedTasks {
 public:
  AbandonedTasks() = default;
  AbandonedTasks(const AbandonedTasks&) = delete;
  AbandonedTasks& operator=(const AbandonedTasks&) = delete;
  /// Waits for all that hang.
  ~AbandonedTasks();

  /// Destroys the task here, or on a thread of its own if it is still at work shortly afterwards. nullptr:
  /// nothing.
  void destroy(std::shared_ptr<task::Task> task);
  /// Whether all tasks have been destroyed.
  [[nodiscard]] bool empty();

 private:
  struct Removed {
    std::shared_ptr<task::Task> task;
    std::atomic<bool> ended{false};  ///< AT1: released after the task is destroyed, acquired before the join
    std::thread thread;
  };
  void forget_ended() SEGUE_REQUIRES(mutex_);

  Mutex mutex_;
  std::list<Removed> waiting_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::task_host::detail
