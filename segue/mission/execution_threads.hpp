// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/concurrent/thread_pool.hpp>
#include <segue/mission/action_runner.hpp>

#include <functional>
#include <list>
#include <stop_token>
#include <vector>

namespace segue::mission {

/// Executions of actions that block, each in a thread of its own. The destructor ends them as preempted, and
/// waits for them. Thread safe.
class ExecutionThreads {
 public:
  /// The work of an execution until it ends or is asked to stop. It writes its outputs, which have their
  /// defaults at first.
  using Body = std::function<Ending(const std::stop_token& stop, std::vector<type::Value>& outputs)>;

  ExecutionThreads() = default;
  ~ExecutionThreads();
  ExecutionThreads(const ExecutionThreads&) = delete;
  ExecutionThreads& operator=(const ExecutionThreads&) = delete;

  /// Defers the end of the call to that of `body`.
  void start(ActionCall& call, Body body);
  /// Runs `work` until it returns. std::system_error if there can be no thread, or this is being destroyed.
  void start(std::stop_source stop, std::function<void(const std::stop_token& stop)> work);

 private:
  using Stops = std::list<std::stop_source>;

  Mutex mutex_;
  bool closes_ SEGUE_GUARDED_BY(mutex_) = false;
  Stops running_ SEGUE_GUARDED_BY(mutex_);
  /// Keeps some threads for the next executions, since an action is often begun as soon as another one ends.
  concurrent::ThreadPool threads_{"segue-action",
                                  {.threads = concurrent::ThreadPool::kNoLimit, .idle = 4}};  // ends first
};

}  // namespace segue::mission
