// SPDX-License-Identifier: Apache-2.0
#include "concurrent_engine_implementation.hpp"

#include <algorithm>

namespace segue::task_network {

/// Takes the node off the path, and all nodes that are on the path only because of it.
void ConcurrentEngine::Implementation::skip(NodeId node) {
  to_skip_.push_back(node);
  if (to_skip_.size() > 1) return;  // a caller further up the stack works the list off
  for (std::size_t i = 0; i < to_skip_.size(); ++i)
    skip_one(to_skip_[i]);
  to_skip_.clear();
}

void ConcurrentEngine::Implementation::skip_one(NodeId node) {
  State& state = at(node);
  if (state.phase == Phase::Done || state.phase == Phase::Skipped) return;
  abandon(node);
  state.phase = Phase::Skipped;
  log(node, LogKind::Skip);
  if (expansion_ != nullptr) expansion_->skipped(node);
  const auto accesses = network_.accesses(node);
  for (std::uint32_t i = 0; i < accesses.size(); ++i) {
    if (!accesses[i].writes) continue;
    writes_[network_[node].first_access + i] = 1;
    facts_changed(network_[node].first_access + i);
  }
  outputs_changed(node);
  announce_outputs(node);
  return_copies_of_producers(node);
  for (const Dependency& dependency : order_.after(node)) {
    if (dependency.reason() == Reason::Condition && index(dependency.to) < states_.size())
      to_skip_.push_back(dependency.to);
  }
  if (state.commit_gate == 0) work_.push_back(node);
}

/// Leaves the queue that the node waits in, or cancels its run.
void ConcurrentEngine::Implementation::abandon(NodeId node) {
  const State& state = at(node);
  switch (state.phase) {
    case Phase::Copying:
      copies_.give_up(rank(node));
      break;
    case Phase::Queued:
      pool_.withdraw(rank(node), network_.claims(node));
      return_copy(node);
      break;
    case Phase::Ready:
      ready_.remove(rank(node));
      note_speculative(node, false);
      pool_.release(network_.claims(node), false);
      return_copy(node);
      break;
    case Phase::Running:
      cancel_run(node);
      break;
    case Phase::Parked:
      discard(node);
      break;
    default:
      break;
  }
}

void ConcurrentEngine::Implementation::cancel_run(NodeId node) {
  State& state = at(node);
  if (!state.active || state.cancelled) return;
  state.cancelled = true;
  note_speculative(node, false);
  note_preempted(node, true);
  log(node, LogKind::Cancel);
  environment_.cancel(node, state.attempt, events_);
}

/// The result was based on a wrong prediction: the node runs again.
void ConcurrentEngine::Implementation::invalidate(NodeId node) {
  State& state = at(node);
  if (state.phase == Phase::Running) return cancel_run(node);
  if (state.phase != Phase::Parked) return;
  if (planted(EngineFault::AppliesEffectsTwice)) apply_effects(node, judged(node));
  discard(node);
  state.phase = Phase::Waiting;
  work_.push_back(node);
}

/// No node from here on in program order is reached any more.
void ConcurrentEngine::Implementation::truncate(NodeId node) {
  limit_ = std::min(limit_, index(node));
  patience_.with_all(events_.elapsed() + environment_.patience());
  for (std::uint32_t i = limit_; i < states_.size(); ++i) {
    const NodeId later{i};
    State& state = at(later);
    if (state.lost) continue;  // it has been dealt with
    const bool runs = state.phase == Phase::Running;
    abandon(later);
    if (!runs && state.phase != Phase::Done && state.phase != Phase::Skipped) state.phase = Phase::Waiting;
  }
}

/// Invalidates consumers that have used outputs which changed.
void ConcurrentEngine::Implementation::outputs_changed(NodeId node) {
  if (planted(EngineFault::KeepsStaleInputs)) return;
  for (const Dependency& dependency : order_.after(node)) {
    if (dependency.reason() != Reason::Data || index(dependency.to) >= states_.size()) continue;
    const Phase phase = at(dependency.to).phase;
    const bool used = phase == Phase::Running || phase == Phase::Parked;
    if (used && !irreversible(dependency.to) && !inputs_are_valid(dependency.to)) invalidate(dependency.to);
  }
}

/// A write differs from its prediction: invalidates the readers that relied on it, up to the next certain
/// write.
void ConcurrentEngine::Implementation::facts_changed(std::uint32_t place) {
  if (planted(EngineFault::NeverValidates)) return;
  for (std::uint32_t i = network_.access(place).next; i != kNone; i = network_.access(i).next) {
    const Access& access = network_.access(i);
    if (index(access.node) >= states_.size()) return;
    const State& state = at(access.node);
    if (access.reads && network_[access.node].kind == ActionClass::Pure) {
      const bool read = state.phase == Phase::Running || state.phase == Phase::Parked;
      if (read && projected(access) != (reads_[i] == 3)) invalidate(access.node);
      const bool waits = state.phase == Phase::Waiting || state.phase == Phase::Queued;
      if (waits && state.start_gate == 0) work_.push_back(access.node);
    }
    const NodeRecord& node = network_[access.node];
    const bool certain = !node.uncertain && !node.branches && network_.conditions(access.node).empty();
    if (access.writes && certain) return;
  }
}

}  // namespace segue::task_network
