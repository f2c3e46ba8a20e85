// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/tasks.capnp.h>
#include <segue/control/detail/rpc_channel.hpp>
#include <segue/host/task_host.hpp>

#include <functional>
#include <memory>
#include <vector>

namespace segue::control::detail {

/// Gives the capability that is asked, in the loop of its channel.
using TasksOf = std::function<wire::TaskAccess::Client(RpcChannel::Connection&)>;

/// The batches of actions that were sent through one connection and have not ended.
/// What comes back is not trusted: each action is reported once, whatever the other side answers. Thread
/// safe.
class BatchClient {
 public:
  BatchClient(std::shared_ptr<RpcChannel> channel, TasksOf tasks);
  /// Reports what has not ended as Unavailable.
  ~BatchClient();
  BatchClient(const BatchClient&) = delete;
  BatchClient& operator=(const BatchClient&) = delete;

  /// Sends a batch and returns at once. `completed` gets each action once, in the loop of the channel; where
  /// the process does not answer, with an error.
  void begin(std::vector<model::Action> actions, TimePoint deadline, host::Completion completed);

 private:
  class Open;
  struct Batch;
  const std::shared_ptr<RpcChannel> channel_;
  const TasksOf tasks_;
  const std::shared_ptr<Open> open_;
};

}  // namespace segue::control::detail
