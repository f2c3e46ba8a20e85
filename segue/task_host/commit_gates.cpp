// SPDX-License-Identifier: Apache-2.0
#include <segue/task_host/commit_gates.hpp>

namespace segue::task_host::detail {

task::CommitGatePtr CommitGates::for_connection() {
  const Lock lock(mutex_);
  // Transitions are armed after Prepare, so an armed gate is left of an earlier one.
  if (!gate_ || gate_->armed()) gate_ = std::make_shared<task::CommitGate>();
  return gate_;
}

task::CommitGatePtr CommitGates::arm(std::shared_ptr<const task::CommitWord> word, std::uint64_t number) {
  const Lock lock(mutex_);
  if (!gate_ || gate_->armed()) gate_ = std::make_shared<task::CommitGate>();
  gate_->arm(std::move(word), number);
  return gate_;
}

void CommitGates::drop() {
  const Lock lock(mutex_);
  gate_.reset();
}

}  // namespace segue::task_host::detail
