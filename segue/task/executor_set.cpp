// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/task/executor_set.hpp>

namespace segue::task {

namespace {

std::string thread_settings(const Activity& activity) {
  std::string text(to_string(activity.scheduler));
  if (activity.scheduler != Scheduler::Normal) text += " " + std::to_string(activity.priority);
  if (!activity.cpus.empty()) text += " on cpus";
  for (const int cpu : activity.cpus)
    text += " " + std::to_string(cpu);
  if (activity.spin > Duration::zero()) text += " that spins for " + format_duration(activity.spin);
  return text;
}

}  // namespace

Result<std::shared_ptr<Executor>> ExecutorSet::executor_for(const std::string& task_id,
                                                            const Activity& activity) {
  if (activity.thread.empty()) {
    auto own = ThreadExecutor::create(task_id, activity);
    if (!own) return std::move(own.error());
    return std::shared_ptr<Executor>(std::move(*own));
  }
  const Lock lock(mutex_);
  Group& group = groups_[activity.thread];
  if (std::shared_ptr<ThreadExecutor> running = group.executor.lock()) {
    if (thread_settings(activity) == thread_settings(group.activity))
      return std::shared_ptr<Executor>(running);
    return fail(ErrorCode::InvalidArgument,
                "thread group " + quote(activity.thread) + " already runs as " +
                    thread_settings(group.activity) + " for task " + quote(group.first_task) + ", " +
                    quote(task_id) + " wants " + thread_settings(activity) +
                    "; give both the same, or another group",
                task_id);
  }
  auto made = ThreadExecutor::create(activity.thread, activity);
  if (!made) return std::move(made.error());
  group = {*made, activity, task_id};
  return std::shared_ptr<Executor>(std::move(*made));
}

ExecutorSet& ExecutorSet::of_process() {
  static ExecutorSet set;
  return set;
}

}  // namespace segue::task
