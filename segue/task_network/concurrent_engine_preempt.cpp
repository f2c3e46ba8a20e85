// SPDX-License-Identifier: Apache-2.0
#include "concurrent_engine_implementation.hpp"

#include <algorithm>

namespace segue::task_network {

// Speculative runs hold units and workers only until a node that is certain to count needs them: it preempts
// speculative runs: for units only those of later nodes, for a worker any. So the lowest unfinished node
// waits only for runs that count, and no network takes longer than its sequential execution. Every preemption
// lets a run begin that counts, so there are finitely many.

/// Records the units of a speculative run, from its start until it ends or is cancelled.
void ConcurrentEngine::Implementation::note_speculative(NodeId node, bool speculative) {
  if (!speculative)
    preemptible_.give_back(rank(node), network_.claims(node));
  else if (!certain(node))
    preemptible_.hold(rank(node), network_.claims(node));
}

/// Records the units and the worker that a cancelled run still holds, until it ends.
void ConcurrentEngine::Implementation::note_preempted(NodeId node, bool preempted) {
  if (needs_worker(node)) preempted_workers_ = preempted ? preempted_workers_ + 1 : preempted_workers_ - 1;
  preemptible_.cancelled(network_.claims(node), preempted);
}

/// Adds the speculative runs, the last in rank first, that must be preempted for the node to get the units
/// that it claims. False if even all of them would not be enough.
bool ConcurrentEngine::Implementation::collect_holders(NodeId node, const Claim& claim,
                                                       std::vector<NodeId>& holders) {
  std::uint64_t coming = preemptible_.coming(claim.resource);
  const auto& [candidates, held] = preemptible_.holders(claim.resource);
  const auto missing = pool_.missing(rank(node), claim, coming + held);
  if (!missing) return false;
  for (const NodeId holder : holders)
    coming += PreemptibleUnits::blocked(network_.claims(holder), claim.resource);
  for (auto last = candidates.rbegin(); last != candidates.rend() && coming < *missing && rank(node) < *last;
       ++last) {
    // The holder may have become certain to count meanwhile.
    const bool known = std::ranges::find(holders, last->node) != holders.end();
    if (known || (at(last->node).phase == Phase::Running && certain(last->node))) continue;
    holders.push_back(last->node);
    coming += PreemptibleUnits::blocked(network_.claims(last->node), claim.resource);
  }
  return coming >= *missing;
}

/// Requires that the node is certain to count and waits for units.
void ConcurrentEngine::Implementation::preempt_for_units(NodeId node) {
  if (!preemptible_.held_behind(rank(node), network_.claims(node))) return;
  std::vector<NodeId> holders;
  for (const Claim& claim : network_.claims(node)) {
    if (!collect_holders(node, claim, holders)) return;
  }
  for (const NodeId holder : holders)
    preempt(holder);
}

/// Preempts for nodes that are certain to count and still wait for units, and for those that lack only a
/// worker, whatever their rank.
void ConcurrentEngine::Implementation::preempt_for_waiting() {
  pool_.still_waiting(granted_);
  for (const NodeId node : granted_) {
    if (at(node).phase == Phase::Queued && certain(node)) preempt_for_units(node);
  }
  if (options_.workers == 0 || pause_.paused()) return;
  const std::uint64_t coming = options_.workers - at_work_ + preempted_workers_;
  for (std::uint64_t wanted = ready_.certain_count(); wanted > coming; --wanted) {
    const NodeId* last = nullptr;
    for (const NodeId& node : running_) {
      const bool speculative = (!certain(node) || planted(EngineFault::PreemptsWhatCounts)) &&
                               !at(node).cancelled && needs_worker(node);
      if (speculative && (last == nullptr || rank(*last) < rank(node))) last = &node;
    }
    if (last == nullptr) return;
    preempt(*last);
  }
}

/// The node releases what it holds, and waits again.
void ConcurrentEngine::Implementation::preempt(NodeId node) {
  if (planted(EngineFault::NeverPreempts)) return;
  State& state = at(node);
  if (state.phase == Phase::Running) {
    ++statistics_.preempted;
    return cancel_run(node);
  }
  abandon(node);
  state.phase = Phase::Waiting;
  work_.push_back(node);
}

/// Ends nodes that have lost a race; false if there are none.
bool ConcurrentEngine::Implementation::take_lost() {
  if (expansion_ == nullptr) return false;
  const std::vector<NodeId> lost = expansion_->take_lost();
  for (const NodeId node : lost)
    lose(node);
  return !lost.empty();
}

/// The node releases its units. A run that is certain to count is asked to end, and counts as it ends.
void ConcurrentEngine::Implementation::lose(NodeId node) {
  State& state = at(node);
  if (state.passed || state.phase == Phase::Done || beyond(node)) return;
  state.lost = true;
  if (state.phase == Phase::Running && settled(node)) {
    patience_.with(node, events_.elapsed() + environment_.patience());
    return cancel_run(node);
  }
  skip(node);
}

/// Takes runs that have lost and not ended in time as aborted; false if no time was up.
bool ConcurrentEngine::Implementation::give_up_lost() {
  bool up = false;
  while (const auto node = patience_.next_overdue(events_.elapsed())) {
    up = true;
    if (!at(*node).active) continue;
    events_.finish_at(events_.now(), *node, at(*node).attempt,
                      refusal(*node, "it was preempted, but went on; given up"));
  }
  return up;
}

}  // namespace segue::task_network
