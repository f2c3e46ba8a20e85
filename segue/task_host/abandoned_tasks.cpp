// SPDX-License-Identifier: Apache-2.0
#include <segue/task_host/abandoned_tasks.hpp>

#include <segue/base/log.hpp>
#include <segue/concurrent/thread.hpp>

#include <utility>

namespace segue::task_host::detail {

namespace {

/// How long a task at work may take until it is left to a thread of its own.
constexpr Duration kBriefWork = std::chrono::milliseconds(20);

}  // namespace

AbandonedTasks::~AbandonedTasks() {
  for (Removed& removed : waiting_) {
    removed.thread.join();
  }
}

void AbandonedTasks::destroy(std::shared_ptr<task::Task> task) {
  if (task == nullptr || task->settle(RealClock::instance().now() + kBriefWork)) {
    return;
  }
  log(LogLevel::Warning, task->id(),
      "is removed although it is still at work; it is destroyed when that ends");
  const Lock lock(mutex_);
  forget_ended();
  Removed& removed = waiting_.emplace_back();
  removed.task = std::move(task);
  removed.thread = concurrent::start_thread("segue-abandoned", [&removed] {
    // Others may hold the task for a moment. None of them must be the last before the task can be destroyed.
    static_cast<void>(removed.task->settle(TimePoint::max()));
    removed.task.reset();
    removed.ended.store(true, std::memory_order_release);  // AT1
  });
}

bool AbandonedTasks::empty() {
  const Lock lock(mutex_);
  forget_ended();
  return waiting_.empty();
}

void AbandonedTasks::forget_ended() {
  for (auto removed = waiting_.begin(); removed != waiting_.end();) {
    if (!removed->ended.load(std::memory_order_acquire)) {  // pairs with AT1
      ++removed;
      continue;
    }
    removed->thread.join();
    removed = waiting_.erase(removed);
  }
}

}  // namespace segue::task_host::detail
