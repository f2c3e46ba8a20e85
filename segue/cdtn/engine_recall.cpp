// SPDX-License-Identifier: Apache-2.0
#include "engine_implementation.hpp"

#include <algorithm>

namespace segue::cdtn {

// Units and workers are only lent to runs ahead: a node that is certain to be wanted gets them back, units
// from those that come after it, workers from anybody. So the lowest node of all never waits but for runs
// that count, and no network takes longer than one node after the other. Each recall lets a run begin that
// counts, so they come to an end.

/// What a run has that is not certain to be wanted; until it ends, or is told to.
void Engine::Implementation::note_lent(NodeId node, bool lent) {
  if (lent && certain(node)) return;
  for (const Claim& claim : network_.claims(node)) {
    std::set<Rank>& lenders = lent_[index(claim.resource)];
    if (lent)
      lenders.insert(rank(node));
    else
      lenders.erase(rank(node));
  }
}

/// A run that was cancelled still holds what it has until it ends.
void Engine::Implementation::note_returning(NodeId node, bool returning) {
  returning_workers_ = returning ? returning_workers_ + 1 : returning_workers_ - 1;
  for (const Claim& claim : network_.claims(node)) {
    if (claim.op != ResourceOp::Block || claim.group != kNone) continue;
    std::uint64_t& units = returning_[index(claim.resource)];
    units = returning ? units + claim.count : units - claim.count;
  }
}

/// Adds the runs ahead that must give back units of the claim's resource for the node to get its own, the
/// last in order first. False where that would not be enough.
bool Engine::Implementation::collect_lenders(NodeId node, const Claim& claim, std::vector<NodeId>& lenders) {
  const auto missing = pool_.missing(rank(node), claim);
  if (!missing) return false;
  std::uint64_t coming = returning_[index(claim.resource)];
  const auto give = [&](NodeId lender) {
    for (const Claim& lent : network_.claims(lender)) {
      if (lent.resource == claim.resource && lent.op == ResourceOp::Block) coming += lent.count;
    }
  };
  for (const NodeId lender : lenders)
    give(lender);
  const auto& lent = lent_[index(claim.resource)];
  for (auto last = lent.rbegin(); last != lent.rend() && coming < *missing && rank(node) < *last; ++last) {
    // Who got it may be certain to be wanted by now.
    const bool known = std::ranges::find(lenders, last->node) != lenders.end();
    if (known || (at(last->node).phase == Phase::Running && certain(last->node))) continue;
    lenders.push_back(last->node);
    give(last->node);
  }
  return coming >= *missing;
}

/// The node is certain to be wanted and waits for units.
void Engine::Implementation::recall_units(NodeId node) {
  std::vector<NodeId> lenders;
  for (const Claim& claim : network_.claims(node)) {
    if (!collect_lenders(node, claim, lenders)) return;
  }
  for (const NodeId lender : lenders)
    recall(lender);
}

/// For those who are certain to be wanted and still wait for units; and for those who have all but a worker,
/// whatever their place.
void Engine::Implementation::recall_for_waiting() {
  pool_.still_waiting(granted_);
  for (const NodeId node : granted_) {
    if (at(node).phase == Phase::Queued && certain(node)) recall_units(node);
  }
  const std::uint64_t coming = options_.workers - running_.size() + returning_workers_;
  for (std::uint64_t wanted = ready_.size(); wanted > coming; --wanted) {
    const NodeId* last = nullptr;
    for (const NodeId& node : running_) {
      const bool ahead = (!certain(node) || planted(Fault::RecallsWhatCounts)) && !at(node).cancelled;
      if (ahead && (last == nullptr || rank(*last) < rank(node))) last = &node;
    }
    if (last == nullptr) return;
    recall(*last);
  }
}

/// The node gives back what it has, and waits again.
void Engine::Implementation::recall(NodeId node) {
  if (planted(Fault::NeverRecalls)) return;
  State& state = at(node);
  if (state.phase == Phase::Running) {
    ++statistics_.recalled;
    return cancel_run(node);
  }
  abandon(node);
  state.phase = Phase::Waiting;
  work_.push_back(node);
}

}  // namespace segue::cdtn
