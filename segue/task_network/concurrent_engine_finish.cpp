// SPDX-License-Identifier: Apache-2.0
#include "concurrent_engine_implementation.hpp"

#include <algorithm>
#include <utility>

namespace segue::task_network {

namespace {

bool same_outputs(const ReportPtr& a, const ReportPtr& b) {
  const auto* first = a ? a->outputs.get() : nullptr;
  const auto* second = b ? b->outputs.get() : nullptr;
  return first == second || (first != nullptr && second != nullptr && *first == *second);
}

bool has_effects(const TaskNetwork& network, NodeId node) {
  return std::ranges::any_of(network.accesses(node), [](const Access& access) { return access.writes; });
}

bool succeeded(const TaskNetwork& network, NodeId node, const ReportPtr& report) {
  return (report ? report->outcome : kSuccess) == network[node].expected;
}

}  // namespace

void ConcurrentEngine::Implementation::take_end(CompletionQueue::End& end) {
  heed_stop();
  const NodeId node = end.node;
  if (index(node) == kNone) {  // posted by wake()
    pause_.take(stopped_);
    return unit_waits_.take(pool_);
  }
  State& state = at(node);
  state.active = false;
  result_of(node).ended = end.when;
  at(running_.back()).run_place = state.run_place;
  running_[state.run_place] = running_.back();
  running_.pop_back();
  if (needs_worker(node)) --at_work_;
  log(node, LogKind::End);
  environment_.ended(node, end.attempt);
  if (state.claims) note_speculative(node, false);
  if (state.cancelled) note_preempted(node, false);
  if (state.claims && !(state.cancelled && planted(EngineFault::KeepsPreemptedUnits)))
    pool_.release(network_.claims(node), succeeded(network_, node, end.report));
  if (end.report) {
    learn_effects(*end.report);
    learn_units(*end.report);
  }
  if (irreversible(node)) {
    reports_[index(node)] = std::move(end.report);
    return commit(node, judged(node));
  }
  const bool ends_lost = state.lost && state.phase == Phase::Running;
  if (!state.cancelled || ends_lost || planted(EngineFault::CountsPreempted)) {
    park(node, std::move(end.report));
    // The node may decide a race before its units are granted to a node that has lost that race.
    if (expansion_ != nullptr && expansion_->races()) check(node);
    return;
  }
  discard(node);
  if (state.phase == Phase::Skipped) return;
  state.phase = Phase::Waiting;
  work_.push_back(node);
}

/// Turns effects that were reported by name into effects on facts.
void ConcurrentEngine::Implementation::learn_effects(Report& report) {
  if (report.named_effects.empty()) return;
  auto& effects = report.effects ? *report.effects : report.effects.emplace();
  for (const NamedEffect& named : report.named_effects) {
    if (growing_ != nullptr) {
      if (const auto fact = growing_->facts.intern_named(named.fact)) effects.push_back({*fact, named.value});
    } else if (const auto known = network_.facts.find(named.fact)) {
      effects.push_back({*known, named.value});
    }
  }
}

/// Takes in units that were reported by name. Nobody waits for any: what comes after the node has not begun.
void ConcurrentEngine::Implementation::learn_units(const Report& report) {
  for (const NamedUnits& named : report.named_units) {
    auto resource = network_.resources.find(named.resource);
    if (!resource && growing_ != nullptr) resource = growing_->resources.intern(named.resource);
    if (!resource) continue;
    pool_.grow();
    pool_.change(*resource, named.change);
  }
}

void ConcurrentEngine::Implementation::discard(NodeId node) {
  const State& state = at(node);
  wasted_.push_back({node, result_of(node).started, result_of(node).ended});
  if (state.speculative) ++statistics_.wasted;
  log(node, LogKind::Discard);
  if (const ReportPtr& report = reports_[index(node)]) report->pending.reset();
  return_copy(node);
}

/// Keeps a result until the node may commit.
void ConcurrentEngine::Implementation::park(NodeId node, ReportPtr report) {
  State& state = at(node);
  state.phase = Phase::Parked;
  ReportPtr& kept = reports_[index(node)];
  const bool changed = state.version == 0 || !same_outputs(kept, report);
  kept = std::move(report);
  if (changed) ++state.version;
  if (at(node).asked_world && !network_[node].reads_world) {
    kept = std::make_unique<Report>();
    kept->outcome = kAborted;
    kept->error = "looked at the world without declaring reads_world";
  }
  if (changed && state.announced) outputs_changed(node);
  if (!kept || kept->outcome != kAborted) announce_outputs(node);
  work_.push_back(node);
}

void ConcurrentEngine::Implementation::try_commit(NodeId node) {
  if (at(node).lost) return commit_lost(node);
  if (network_[node].reads_world && !world_is_known_to(node)) return;
  if (has_effects(network_, node)) {
    if (const auto risk = risk_before(node)) return turns_.wait(node, *risk);
  }
  const ReportPtr& report = reports_[index(node)];
  const PendingChanges* pending = report ? report->pending.get() : nullptr;
  const bool has_changes = pending != nullptr && !pending->empty();
  if (has_changes && pending->needs_turn() && !turn_has_come(node)) return;
  if (reads_are_valid(node) && inputs_are_valid(node) && world_is_valid(node) &&
      (!has_changes || pending->valid()))
    return commit_with_changes(node);
  invalidate(node);
}

/// Commits a node that has lost a race. It cannot run again: if its result was based on data that have
/// changed meanwhile, it counts as one that has not begun.
void ConcurrentEngine::Implementation::commit_lost(NodeId node) {
  const ReportPtr& report = reports_[index(node)];
  const PendingChanges* pending = report ? report->pending.get() : nullptr;
  const bool has_changes = pending != nullptr && !pending->empty();
  if (has_changes && pending->needs_turn() && !turn_has_come(node)) return;
  if (!has_changes || (inputs_are_valid(node) && pending->valid())) return commit_with_changes(node);
  skip(node);
}

/// Whether all nodes before it have passed, those in parallel aside. If not, it is checked again once the
/// first of them has.
bool ConcurrentEngine::Implementation::turn_has_come(NodeId node) {
  for (std::uint32_t i = prefix_; i < index(node); ++i) {
    if (states_[i].passed || network_.in_parallel(NodeId{i}, node)) continue;
    turns_.wait(node, NodeId{i});
    return false;
  }
  return true;
}

/// The first node that has not passed and may change what the node sees of the world: those before it, but
/// for what is in parallel and changes nothing.
std::optional<NodeId> ConcurrentEngine::Implementation::first_that_changes_world_of(NodeId node) const {
  for (NodeId before{prefix_}; before < node; before = NodeId{index(before) + 1}) {
    const bool changes_nothing = network_.effects_are_declared && !network_[before].opaque &&
                                 !has_effects(network_, before) && network_.in_parallel(before, node);
    if (!at(before).passed && !changes_nothing) return before;
  }
  return std::nullopt;
}

/// Whether the world that the node sees is real. If not, it is checked again once that may be so; in no
/// branch, advance_prefix() does that.
bool ConcurrentEngine::Implementation::world_is_known_to(NodeId node) {
  const auto first = first_that_changes_world_of(node);
  if (first && network_[node].parallel_branch != kNone) turns_.wait(node, *first);
  return !first;
}

/// Commits a node with its changes beside the network. Where a later node has used these already, the run
/// cannot be that of the program any more, whoever handles aborts.
void ConcurrentEngine::Implementation::commit_with_changes(NodeId node) {
  const ReportPtr& report = reports_[index(node)];
  if (!report || !report->pending) return commit(node, judged(node));
  const auto changes = std::exchange(report->pending, nullptr);
  const auto applied = changes->apply();
  if (applied) return commit(node, judged(node));
  NodeOutcome outcome;
  outcome.outcome = kAborted;
  outcome.failure = std::make_unique<Error>(applied.error());
  outcome.failure->subject = network_.label(node);
  commit(node, std::move(outcome));
}

NodeOutcome ConcurrentEngine::Implementation::judged(NodeId node) const {
  return judge(network_, node, reports_[index(node)].get());
}

/// The effects and the outcome of the node count from now on.
void ConcurrentEngine::Implementation::commit(NodeId node, NodeOutcome outcome) {
  State& state = at(node);
  if (outcome.failure) take_lost();  // a race may have been decided in this very step
  if (state.phase == Phase::Skipped) return;
  if (state.lost && outcome.failure) {
    outcome.failure.reset();
    if (!state.cancelled) outcome.outcome = kPreempted;  // it ended in the very step in which it lost
  }
  state.outcome = outcome.outcome;
  state.phase = Phase::Done;
  result_of(node).committed = events_.now();
  if (state.version == 0) state.version = 1;
  log(node, LogKind::Commit);
  apply_effects(node, outcome);
  if (outcome.failure) return fail_node(node, std::move(*outcome.failure));
  pass(node);
}

void ConcurrentEngine::Implementation::fail_node(NodeId node, Error error) {
  State& state = at(node);
  state.failed = true;
  if (beyond(node)) return;  // it was preempted
  failed_ = node;
  error_ = std::move(error);
  if (planted(EngineFault::GoesOnAfterFailure)) return pass(node);
  if (expansion_ != nullptr) {
    expansion_->failed(node);
    take_lost();
  }
  truncate(node);
}

void ConcurrentEngine::Implementation::apply_effects(NodeId node, const NodeOutcome& outcome) {
  const std::uint32_t first = network_[node].first_access;
  const auto accesses = network_.accesses(node);
  for (std::uint32_t i = 0; i < accesses.size(); ++i) {
    const Access& access = accesses[i];
    if (!access.writes) continue;
    std::uint8_t written = outcome.as_declared ? (access.value ? 3 : 2) : 1;
    for (const Literal& literal : outcome.effects) {
      if (literal.fact == access.fact) written = literal.value ? 3 : 2;
    }
    writes_[first + i] = written;
    if (written != 1) world_.set({access.fact, written == 3});
    if (written != (access.value ? 3 : 2)) facts_changed(first + i);
  }
  for (const Literal& literal : outcome.effects)
    apply_undeclared(node, literal);
}

void ConcurrentEngine::Implementation::apply_undeclared(NodeId node, const Literal& literal) {
  const auto accesses = network_.accesses(node);
  if (std::ranges::any_of(accesses,
                          [&](const Access& one) { return one.writes && one.fact == literal.fact; }))
    return;
  undeclared_.add(node, literal);
  world_.set(literal);
}

/// Everything that depends on the node may take it as settled.
void ConcurrentEngine::Implementation::pass(NodeId node) {
  State& state = at(node);
  state.passed = true;
  ++passed_count_;
  if (!planted(EngineFault::PassesAtStart) || state.attempt == 0) notify(node);
  state.announced = state.began = true;
  settle(node);
  turns_.passed(node, work_);
  if (index(node) == prefix_ || index(node) == safe_) advance_prefix();
  if (expansion_ == nullptr || state.phase != Phase::Done) return;
  if (state.outcome != kPreempted) last_done_ = node;  // who was preempted ended because of another one
  const ReportPtr& report = reports_[index(node)];
  expansion_->ended(node, state.outcome, report ? report->outputs.get() : nullptr);
  if (expansion_->races()) take_lost();
}

/// Releases what the node no longer needs.
void ConcurrentEngine::Implementation::settle(NodeId node) {
  if (at(node).claims) leave_groups(node);
  return_copies_of_producers(node);
  if (!at(node).has_copy) return;
  for (const Dependency& dependency : order_.after(node)) {
    if (dependency.reason() == Reason::Data) return;
  }
  return_copy(node);
}

void ConcurrentEngine::Implementation::notify(NodeId node) {
  const State& state = at(node);
  for (const Dependency& dependency : order_.after(node)) {
    if (dependency.reason() == Reason::Resource && state.began) continue;
    arrive(dependency);
  }
}

/// `from` has passed or, for a resource, begun.
void ConcurrentEngine::Implementation::arrive(const Dependency& dependency) {
  if (index(dependency.to) >= states_.size() || !counts(dependency)) return;
  State& to = at(dependency.to);
  const bool firm = irreversible(dependency.to);
  if (dependency.reason() == Reason::Resource) {
    --(firm ? to.commit_gate : to.start_gate);
  } else {
    --to.commit_gate;
    const bool news = dependency.reason() == Reason::Data && !firm && !at(dependency.from).announced;
    if (news || gates_start(dependency)) --to.start_gate;
    meet(dependency);
  }
  if (to.commit_gate == 0 || (!firm && to.start_gate == 0)) work_.push_back(dependency.to);
}

/// A condition that is not met takes the node off the path.
void ConcurrentEngine::Implementation::meet(const Dependency& dependency) {
  if (dependency.reason() != Reason::Condition || planted(EngineFault::SkippedStillActs)) return;
  const State& from = at(dependency.from);
  if (from.phase == Phase::Skipped || static_cast<std::uint32_t>(from.outcome) != dependency.subject)
    return skip(dependency.to);
  if (from.outcome != network_[dependency.from].expected) assumptions_changed(dependency.to);
}

/// The node was assumed to be off the path and may be on it: checks readers that relied on its effects not
/// happening.
void ConcurrentEngine::Implementation::assumptions_changed(NodeId node) {
  const auto accesses = network_.accesses(node);
  for (std::uint32_t i = 0; i < accesses.size(); ++i) {
    if (accesses[i].writes) facts_changed(network_[node].first_access + i);
  }
}

/// Lets consumers run on outputs that may still be speculative.
void ConcurrentEngine::Implementation::announce_outputs(NodeId node) {
  if (at(node).announced) return;
  at(node).announced = true;
  for (const Dependency& dependency : order_.after(node)) {
    if (dependency.reason() != Reason::Data || irreversible(dependency.to)) continue;
    if (--at(dependency.to).start_gate == 0) work_.push_back(dependency.to);
  }
}

void ConcurrentEngine::Implementation::announce_start(NodeId node) {
  if (at(node).began) return;
  at(node).began = true;
  for (const Dependency& dependency : order_.after(node)) {
    if (dependency.reason() == Reason::Resource) arrive(dependency);
  }
}

void ConcurrentEngine::Implementation::leave_groups(NodeId node) {
  for (const Claim& claim : network_.claims(node)) {
    if (claim.group != kNone) pool_.leave_group(claim.group);
  }
}

void ConcurrentEngine::Implementation::advance_prefix() {
  const auto size = static_cast<std::uint32_t>(states_.size());
  while (prefix_ < size && states_[prefix_].passed)
    ++prefix_;
  environment_.passed_before(NodeId{prefix_});
  // No node before this one can hold it up now. A run of an irreversible node is not held up anyway.
  if (prefix_ < size && !(irreversible(NodeId{prefix_}) && at(NodeId{prefix_}).phase == Phase::Running))
    work_.push_back(NodeId{prefix_});
  while (safe_ < size && (states_[safe_].passed || network_[NodeId{safe_}].cannot_fail))
    ++safe_;
}

}  // namespace segue::task_network
