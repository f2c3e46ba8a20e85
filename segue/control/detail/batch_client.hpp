// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/detail/link.hpp>
#include <segue/host/task_host.hpp>

#include <memory>
#include <vector>

namespace segue::control::detail {

/// The batches of one connection to a deployment process that are on their way. Thread safe.
class BatchClient {
 public:
  explicit BatchClient(std::shared_ptr<Link> link);

  /// Sends a batch and returns at once. `completed` is told each action once, from the link's loop; what the
  /// process does not answer is an error of each.
  void begin(std::vector<model::Action> actions, TimePoint deadline, host::Completion completed);

 private:
  class Followed;
  struct Batch;
  const std::shared_ptr<Link> link_;
  const std::shared_ptr<Followed> followed_;
};

}  // namespace segue::control::detail
