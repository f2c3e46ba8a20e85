// SPDX-License-Identifier: Apache-2.0
#include "concurrent_engine_implementation.hpp"

#include <algorithm>
#include <cmath>

namespace segue::task_network {

/// The engine as a starting node sees it.
class ConcurrentEngine::Implementation::RunContext final : public NodeContext {
 public:
  RunContext(Implementation& engine, NodeId node)
      : NodeContext(node, engine.at(node).attempt), engine_(engine) {}
  [[nodiscard]] const type::Value* input(std::uint32_t name) const override {
    const auto inputs = engine_.network_.inputs(node());
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      if (inputs[i].input != name || engine_.input_version(node(), i) == 0) continue;
      const ReportPtr& report = engine_.reports_[index(inputs[i].producer)];
      if (!report || !report->outputs) return nullptr;
      return report->outputs->find(engine_.network_.names.name(inputs[i].output));
    }
    return nullptr;
  }
  [[nodiscard]] bool holds(FactId fact) const override {
    for (const Access& access : engine_.network_.accesses(node())) {
      if (access.fact != fact) continue;
      return engine_.network_[node()].kind == ActionClass::Pure ? engine_.projected(access)
                                                                : engine_.world_.holds(fact);
    }
    return false;
  }
  [[nodiscard]] VersionedWorld world() override {
    engine_.at(node()).asked_world = true;
    return engine_.network_[node()].kind == ActionClass::Pure ? engine_.projected_world(node())
                                                              : engine_.real_world(node());
  }
  [[nodiscard]] std::uint32_t units(ResourceId resource) const override {
    return engine_.pool_.total(resource);
  }

 private:
  Implementation& engine_;
};

/// Something that the node waits for may have happened: takes it as far as it can go now.
void ConcurrentEngine::Implementation::check(NodeId node) {
  State& state = at(node);
  if (state.passed || (beyond(node) && !state.lost)) return;
  if (state.phase == Phase::Skipped) {
    if (state.commit_gate == 0 && state.start_gate == 0) pass(node);
    return;
  }
  if ((state.phase != Phase::Waiting && !waits_again(node)) || state.active) return;
  if (irreversible(node)) {
    if (state.commit_gate == 0) try_start(node);
    return;
  }
  if (state.reads_beside && takes_in_order(node) && !turn_has_come(node)) return;
  if (state.start_gate == 0 && (settled(node) || may_run_ahead(node))) try_start(node);
}

/// Whether the node may run before it is certain to count. What takes units in program order cannot be
/// repeated.
bool ConcurrentEngine::Implementation::may_run_ahead(NodeId node) const {
  if (!options_.speculate || at(node).observes || takes_in_order(node)) return false;
  return options_.least_likelihood <= 0 ||
         unlikely(node) <= (1 - options_.least_likelihood) * Condition::kCertain;
}

/// How unlikely it is that the conditions of the node which are not decided are met, in parts of
/// Condition::kCertain. The time that a planner saves is at most the time that it takes, if its result counts
/// at all; so what is likeliest to count is worth most for that time.
std::uint16_t ConcurrentEngine::Implementation::unlikely(NodeId node) const {
  if (!at(node).conditional) return 0;
  double likelihood = 1;
  for (const Condition& condition : network_.conditions(node)) {
    if (!at(condition.node).passed) likelihood *= condition.share();
  }
  return static_cast<std::uint16_t>(std::ceil((1 - likelihood) * Condition::kCertain));
}

/// Gives a node that waits for units the place in the queue that its likelihood has now; false if it has it.
bool ConcurrentEngine::Implementation::queue_again(NodeId node) {
  State& state = at(node);
  const std::uint16_t now = unlikely(node);
  if (state.unlikely == now || pool_.has_granted(node)) return false;
  pool_.withdraw(rank(node), network_.claims(node));
  state.unlikely = now;
  claim(node);
  return true;
}

/// Takes a node further that has got beyond waiting for its gates; true if it waits for them again.
bool ConcurrentEngine::Implementation::waits_again(NodeId node) {
  State& state = at(node);
  const bool open = state.commit_gate == 0;
  switch (state.phase) {
    case Phase::Parked:
      if (open || planted(EngineFault::CommitsSpeculation)) try_commit(node);
      return false;
    case Phase::Running:
      if ((open && !world_is_valid(node)) ||
          (state.reads_beside && index(node) == prefix_ && environment_.outdated(node)))
        invalidate(node);
      return false;
    case Phase::Ready:
      if (ready_.remove_speculative(rank(node))) make_ready(node);
      return false;
    case Phase::Copying:
      if (!sees_reality(node)) return false;
      copies_.give_up(rank(node));
      break;
    case Phase::Queued:
      if (false_precondition(node) == nullptr) {
        if (!queue_again(node) && !refuse_for_shortage(node) && certain(node)) preempt_for_units(node);
        return false;
      }
      abandon(node);  // the world has changed since it was queued
      break;
    default:
      return false;
  }
  state.phase = Phase::Waiting;
  state.unlikely = unlikely(node);
  return true;
}

/// Whether everything that the node depends on has happened.
bool ConcurrentEngine::Implementation::settled(NodeId node) const {
  const State& state = at(node);
  return state.commit_gate == 0 && (!state.reads_world || !first_that_changes_world_of(node));
}

/// Whether a run that begins now is certain to count: only a failure of an earlier node could prevent it, for
/// a strict one not even that. Values beside the network may change until all nodes before have passed; a
/// node that takes units in program order has waited for those nodes.
bool ConcurrentEngine::Implementation::certain(NodeId node) const {
  const bool beside = at(node).reads_beside && prefix_ != index(node);
  return settled(node) && (!beside || takes_in_order(node)) && !risk_before(node);
}

/// Whether its units are taken in program order, so it must not run speculatively: a repeated run would take
/// its units after later nodes have taken theirs.
bool ConcurrentEngine::Implementation::takes_in_order(NodeId node) const {
  return at(node).claims && std::ranges::any_of(network_.claims(node), [this](const Claim& claim) {
           const ResourceRecord& resource = network_.resources[claim.resource];
           return resource.varies || resource.grouped;
         });
}

/// The first node before a strict one that can still fail, those in parallel aside: no effect of the strict
/// node may happen before.
std::optional<NodeId> ConcurrentEngine::Implementation::risk_before(NodeId node) const {
  if (!at(node).strict || planted(EngineFault::StrictIsNot)) return std::nullopt;
  for (std::uint32_t i = safe_; i < index(node); ++i) {
    const bool safe = states_[i].passed || network_[NodeId{i}].cannot_fail;
    if (!safe && !network_.in_parallel(NodeId{i}, node)) return NodeId{i};
  }
  return std::nullopt;
}

void ConcurrentEngine::Implementation::try_start(NodeId node) {
  if (irreversible(node) || takes_in_order(node)) {
    if (const auto risk = risk_before(node)) return turns_.wait(node, *risk);
  }
  if (const Access* access = false_precondition(node)) {
    // Before its gate opens the precondition may still become true: facts_changed or the gate calls again.
    if (at(node).commit_gate == 0)
      refuse(node, precondition_error(network_, node, {access->fact, access->needed}));
    return;
  }
  if (admit(node)) claim(node);
}

/// The end of a node that aborts without saying so itself.
ReportPtr ConcurrentEngine::Implementation::refusal(NodeId node, const std::string& why) {
  RunContext context(*this, node);
  return environment_.refuse(context, why);
}

/// A node that cannot start ends as if it had aborted at once.
void ConcurrentEngine::Implementation::refuse(NodeId node, const Error& error) {
  State& state = at(node);
  result_of(node).started = result_of(node).ended = events_.now();
  ReportPtr report = refusal(node, error.message);
  if (!irreversible(node) && report->pending && !report->pending->empty()) {
    note_what_is_read(node);
    return park(node, std::move(report));
  }
  reports_[index(node)] = std::move(report);
  ++state.version;  // outputs of an earlier speculative run may have been used
  outputs_changed(node);
  if (state.claims) announce_start(node);
  commit(node, judged(node));
}

/// Whether all is real that the node depends on. If not, it is checked again once that may be so.
bool ConcurrentEngine::Implementation::sees_reality(NodeId node) {
  return at(node).commit_gate == 0 && (!at(node).reads_world || world_is_known_to(node));
}

/// Reserves a copy of the world for a run on the projected world; false if none is free. Who sees reality
/// needs none, so the holder of a copy never blocks the node that its own result waits for.
bool ConcurrentEngine::Implementation::admit(NodeId node) {
  State& state = at(node);
  if (!copies_.are_limited() || network_[node].kind != ActionClass::Pure) return true;
  if (copies_.are_all_taken()) {
    if (sees_reality(node)) return true;
    copies_.wait(rank(node));
    state.phase = Phase::Copying;
    return false;
  }
  if (settled(node)) return true;
  copies_.take();
  state.has_copy = true;
  return true;
}

void ConcurrentEngine::Implementation::claim(NodeId node) {
  const auto claims = network_.claims(node);
  if (!options_.limited.empty() && environment_.had_begun(node)) pool_.exempt(node);
  if (claims.empty() || pool_.request(rank(node), claims)) return dispatch(node);
  at(node).phase = Phase::Queued;
  if (!refuse_for_shortage(node) && certain(node)) preempt_for_units(node);
}

/// Once all nodes before have passed, nobody can provide what is lacking: later nodes give back the units
/// that they hold, and where units come and go, later nodes have not begun. So the node aborts, as
/// sequentially.
bool ConcurrentEngine::Implementation::refuse_for_shortage(NodeId node) {
  if (index(node) != prefix_ || pool_.has_granted(node)) return false;
  const auto shortage = pool_.shortage(network_.claims(node));
  if (!shortage) return false;
  const Error error = shortage_error(network_, node, *shortage->claim, shortage->there);
  abandon(node);
  at(node).phase = Phase::Waiting;
  refuse(node, error);
  return true;
}

/// Whether the node needs a worker: nodes that are not steps take no time, so they need none.
bool ConcurrentEngine::Implementation::needs_worker(NodeId node) const {
  return options_.workers != 0 && !network_[node].structural;
}

void ConcurrentEngine::Implementation::dispatch(NodeId node) {
  if (at(node).claims) note_speculative(node, true);
  const bool waits = options_.workers != 0 || pause_.paused() || (options_.ahead != 0 && !certain(node));
  if (!waits || network_[node].structural) return launch(node);
  at(node).phase = Phase::Ready;
  ready_.add(rank(node), certain(node));
}

/// Gives a node that holds its units and waits to begin the place that its likelihood has now. Requires that
/// it is not among them.
void ConcurrentEngine::Implementation::make_ready(NodeId node) {
  note_speculative(node, false);
  at(node).unlikely = unlikely(node);
  note_speculative(node, true);
  ready_.add(rank(node), certain(node));
}

void ConcurrentEngine::Implementation::take_granted() {
  for (;;) {
    pool_.granted(granted_);
    if (granted_.empty()) return;
    const std::vector<NodeId> granted = granted_;
    for (const NodeId node : granted) {
      if (at(node).phase == Phase::Queued)
        dispatch(node);
      else  // abandoned in the same step
        pool_.release(network_.claims(node), false);
    }
  }
}

/// Takes out the first node that may begin now: first of those that are certain to count. Others begin as far
/// as the budget for speculative runs reaches.
std::optional<NodeId> ConcurrentEngine::Implementation::next_ready() {
  const auto may_begin = [&](NodeId node) { return !pause_.blocks() || network_[node].structural; };
  const auto is_ahead = [&](NodeId node) { return !network_[node].structural && !certain(node); };
  const bool ahead = ready_.has_speculative() &&
                     (options_.ahead == 0 || std::ranges::count_if(running_, is_ahead) < options_.ahead);
  const auto node = ready_.take_first(ahead, may_begin);
  if (node) pause_.begins(!network_[*node].structural);
  return node;
}

/// Gives free workers and copies of the world to the nodes that wait for them, by rank; workers first to
/// nodes that are certain to count.
void ConcurrentEngine::Implementation::take_waiting() {
  while (options_.workers == 0 || at_work_ < options_.workers) {
    const auto node = next_ready();
    if (!node) break;
    launch(*node);
  }
  copies_.for_each_that_may_try([this](NodeId node) {
    at(node).phase = Phase::Waiting;
    work_.push_back(node);
  });
}

/// The first precondition that is false, in reality or, for a pure node, as projected. Those that are
/// observed are left to the environment.
const Access* ConcurrentEngine::Implementation::false_precondition(NodeId node) const {
  const bool pure = network_[node].kind == ActionClass::Pure;
  for (const Access& access : network_.accesses(node)) {
    if (!access.reads || network_.facts.is_observed(access.fact)) continue;
    if ((pure ? projected(access) : world_.holds(access.fact)) != access.needed) return &access;
  }
  return nullptr;
}

/// Notes the values that the node reads, to be compared when it commits, which may make it run again.
void ConcurrentEngine::Implementation::note_what_is_read(NodeId node) {
  const auto accesses = network_.accesses(node);
  const bool pure = network_[node].kind == ActionClass::Pure;
  for (std::size_t i = 0; i < accesses.size(); ++i) {
    if (!accesses[i].reads) continue;
    const bool value = pure ? projected(accesses[i]) : world_.holds(accesses[i].fact);
    reads_[network_[node].first_access + i] = value ? 3 : 2;
  }
  const std::size_t inputs = network_.inputs(node).size();
  for (std::size_t i = 0; i < inputs; ++i)
    versions_[network_[node].first_input + i] = input_version(node, i);
}

void ConcurrentEngine::Implementation::launch(NodeId node) {
  State& state = at(node);
  if (state.kind == ActionClass::Pure &&
      false_precondition(node) != nullptr) {  // the projection has changed since it was claimed
    note_speculative(node, false);
    pool_.release(network_.claims(node), false);
    return_copy(node);
    state.phase = Phase::Waiting;
    if (state.commit_gate == 0) work_.push_back(node);
    return;
  }
  state.phase = Phase::Running;
  state.active = true;
  state.cancelled = false;
  state.speculative = !certain(node);
  result_of(node).started = events_.now();
  unit_waits_.ended(node, result_of(node).started);
  state.run_place = static_cast<std::uint32_t>(running_.size());
  running_.push_back(node);
  if (needs_worker(node)) ++at_work_;
  ++state.attempt;
  ++statistics_.starts;
  if (state.speculative) ++statistics_.speculative;
  if (state.attempt > 1) ++statistics_.repeated;
  if (!irreversible(node)) note_what_is_read(node);
  if (state.reads_world) {
    guesses_.erase(index(node));  // those of the last run
    world_is_known_to(node);      // or it is checked then
  }
  log(node, LogKind::Start);
  if (state.claims) announce_start(node);
  RunContext context(*this, node);
  environment_.start(context, events_);
  if (planted(EngineFault::PassesAtStart)) notify(node);
}

void ConcurrentEngine::Implementation::return_copy(NodeId node) {
  State& state = at(node);
  if (!state.has_copy) return;
  state.has_copy = false;
  copies_.put_back();
}

/// The copy of the world behind a result is kept until all consumers of the result have ended.
void ConcurrentEngine::Implementation::return_copies_of_producers(NodeId node) {
  if (!copies_.are_limited()) return;
  for (const DataInput& input : network_.inputs(node)) {
    if (!at(input.producer).has_copy) continue;
    bool needed = false;
    for (const Dependency& dependency : order_.after(input.producer)) {
      const Phase phase = at(dependency.to).phase;
      needed |= dependency.reason() == Reason::Data && phase != Phase::Done && phase != Phase::Skipped;
    }
    if (!needed) return_copy(input.producer);
  }
}

}  // namespace segue::task_network
