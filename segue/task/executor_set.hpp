// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/activity.hpp>
#include <segue/base/mutex.hpp>
#include <segue/task/thread_executor.hpp>

#include <map>
#include <memory>
#include <string>

namespace segue::task {

/// The thread groups of a process. A group's thread lives as long as one of its tasks. All functions may be
/// called from any thread.
class ExecutorSet {
 public:
  /// The executor of the group that `activity` names, or a new one for `task_id` alone. The first task of a
  /// group decides its scheduler, priority, processors and spin; InvalidArgument where a later one wants
  /// others.
  Result<std::shared_ptr<Executor>> executor_for(const std::string& task_id, const Activity& activity);

  /// The instance that Task::create uses.
  static ExecutorSet& of_process();

 private:
  struct Group {
    std::weak_ptr<ThreadExecutor> executor;
    Activity activity;
    std::string first_task;
  };
  Mutex mutex_;  ///< guards groups_
  std::map<std::string, Group> groups_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::task
