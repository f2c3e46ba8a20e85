// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/task/commit_gate.hpp>

#include <cstdint>
#include <memory>

namespace segue::task_host::detail {

/// The gate of the transition in progress, which all connections of this process share that begin or end with
/// its commit. It is made by the first connection, armed before the commit and dropped afterwards. Thread
/// safe.
class CommitGates {
 public:
  /// For a connection that begins with the commit, made in Prepare.
  task::CommitGatePtr for_connection();
  /// The gate of the transition, armed now.
  task::CommitGatePtr arm(std::shared_ptr<const task::CommitWord> word, std::uint64_t number);
  /// The transition has ended.
  void drop();

 private:
  Mutex mutex_;
  std::shared_ptr<task::CommitGate> gate_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::task_host::detail
