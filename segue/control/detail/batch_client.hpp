// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/detail/rpc_channel.hpp>
#include <segue/host/task_host.hpp>

#include <memory>
#include <vector>

namespace segue::control::detail {

/// The batches of actions that were sent through one connection to a deployment process and have not ended.
/// What comes back is not trusted: each action is reported once, whatever the process answers. Thread safe.
class BatchClient {
 public:
  explicit BatchClient(std::shared_ptr<RpcChannel> channel);
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
  const std::shared_ptr<Open> open_;
};

}  // namespace segue::control::detail
