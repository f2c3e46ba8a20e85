// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/model/network.hpp>
#include <segue/runtime/event_log.hpp>
#include <segue/task_host/task_host.hpp>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>

namespace segue::runtime::detail {

class RequestWatch;

/// The requests of tasks: tasks of the component runtime::Requests in the running controller say which
/// controllers other tasks have named to them. Each is watched in a thread of its own, as a condition is.
/// Thread safe.
class TaskRequests {
 public:
  static constexpr std::string_view kComponent = "runtime::Requests";
  /// Requests that controller; `who` names the tasks that have. Called in a thread of a watch.
  using Request = std::function<void(const std::string& controller, const std::string& who)>;

  /// `host` and `log` must outlive this.
  TaskRequests(task_host::TaskHost& host, EventLog& log, Request request);
  /// Waits for a request that is being made.
  ~TaskRequests();
  TaskRequests(const TaskRequests&) = delete;
  TaskRequests& operator=(const TaskRequests&) = delete;

  /// The running controller is this from now on. What tasks have requested before this was called first,
  /// under another runtime, is refused.
  void look_at(const model::Network& controller);
  /// Nothing is watched any more. Blocks as the destructor does.
  void end();

 private:
  task_host::TaskHost& host_;
  EventLog& log_;
  const Request request_;
  Mutex mutex_;
  bool is_first_look_ SEGUE_GUARDED_BY(mutex_) = true;
  bool has_ended_ SEGUE_GUARDED_BY(mutex_) = false;
  std::map<model::TaskId, std::unique_ptr<RequestWatch>> watches_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::runtime::detail
