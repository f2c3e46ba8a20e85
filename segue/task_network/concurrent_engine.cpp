// SPDX-License-Identifier: Apache-2.0
#include "concurrent_engine_implementation.hpp"

#include <algorithm>

namespace segue::task_network {

ConcurrentEngine::ConcurrentEngine(const TaskNetwork& network, const Order& order, Environment& environment,
                                   ConcurrentEngineOptions options)
    : implementation_(std::make_unique<Implementation>(network, order, environment, std::move(options))) {}
ConcurrentEngine::ConcurrentEngine(TaskNetwork& network, Expansion& expansion, Environment& environment,
                                   ConcurrentEngineOptions options)
    : implementation_(std::make_unique<Implementation>(network, expansion, environment, std::move(options))) {
}
ConcurrentEngine::~ConcurrentEngine() = default;
RunResult ConcurrentEngine::run() {
  return implementation_->run();
}
void ConcurrentEngine::stop() {
  implementation_->stop();
}
void ConcurrentEngine::pause() {
  implementation_->pause(true);
}
void ConcurrentEngine::resume() {
  implementation_->pause(false);
}
void ConcurrentEngine::step() {
  implementation_->step();
}
void ConcurrentEngine::limit(UnitLimits limits) {
  implementation_->limit(std::move(limits));
}
const Order& ConcurrentEngine::order() const {
  return implementation_->order();
}
std::size_t ConcurrentEngine::bytes() const {
  return implementation_->bytes();
}

ConcurrentEngine::Implementation::Implementation(const TaskNetwork& network, const Order& order,
                                                 Environment& environment, ConcurrentEngineOptions options)
    : network_(network),
      order_(order),
      environment_(environment),
      options_(std::move(options)),
      events_(options_.clock),
      pool_(network.resources),
      world_(network.initial_world),
      copies_(options_.world_copies),
      prefix_world_(network.initial_world) {
  world_.take_attachments_of({});
}

ConcurrentEngine::Implementation::Implementation(TaskNetwork& network, Expansion& plan, Environment& by,
                                                 ConcurrentEngineOptions options)
    : Implementation(network, own_order_, by, std::move(options)) {
  growing_ = &network;
  expansion_ = &plan;
  builder_ = std::make_unique<OrderBuilder>(network, own_order_);
  builder_->extend();  // the nodes that exist already
}

Rank ConcurrentEngine::Implementation::rank(NodeId node) const {
  return {at(node).unlikely, index(node) < options_.priorities.size() ? options_.priorities[index(node)] : 0,
          node};
}

void ConcurrentEngine::Implementation::log(NodeId node, LogKind kind) {
  if (options_.log) log_.push_back({events_.now(), node, at(node).attempt, kind});
}

/// Takes in the nodes that were appended since the last call.
void ConcurrentEngine::Implementation::adopt() {
  const auto first = static_cast<std::uint32_t>(states_.size());
  const std::uint32_t size = network_.size();
  states_.resize(size);
  results_.resize(size);
  reports_.resize(size);
  reads_.resize(network_.access_count());
  writes_.resize(network_.access_count());
  versions_.resize(network_.input_count());
  pool_.grow();
  pool_.take_groups(network_.groups());
  preemptible_.grow(network_.resources.size());
  for (std::uint32_t i = first; i < size; ++i)
    adopt_node(NodeId{i});
}

void ConcurrentEngine::Implementation::adopt_node(NodeId node) {
  State& state = at(node);
  result_of(node).planned_after = last_done_;
  const NodeRecord& record = network_[node];
  state.kind = record.kind;
  state.strict = options_.strict || record.strict;
  state.claims = !network_.claims(node).empty();
  state.conditional = !network_.conditions(node).empty();
  state.reads_world = record.reads_world && !irreversible(node);
  state.reads_beside = record.reads_beside && !irreversible(node);
  state.observes = !irreversible(node) && network_.observes(node);
  for (const Dependency& dependency : order_.before(node))
    count(state, dependency);
  if (state.commit_gate == 0 || (!irreversible(node) && state.start_gate == 0)) work_.push_back(node);
}

/// Whether a speculative run, too, waits until `from` has passed: a sensing node needs the real world in its
/// final state, and the effects of an opaque node cannot be predicted.
bool ConcurrentEngine::Implementation::gates_start(const Dependency& dependency) const {
  const Reason reason = dependency.reason();
  return !irreversible(dependency.to) && (reason == Reason::Fact || reason == Reason::Place) &&
         holds_start(network_, dependency);
}

/// True unless a fault is planted.
bool ConcurrentEngine::Implementation::counts(const Dependency& dependency) const {
  switch (dependency.reason()) {
    case Reason::Fact:
      return !planted(EngineFault::ForgetsFactOrder) || index(dependency.to) % 7 != 3;
    case Reason::Resource:
      return !planted(EngineFault::ForgetsResourceOrder);
    case Reason::Condition:
      return !planted(EngineFault::IgnoresConditions) || !irreversible(dependency.to);
    default:
      return true;
  }
}

void ConcurrentEngine::Implementation::count(State& state, const Dependency& dependency) {
  const State& from = at(dependency.from);
  if (!counts(dependency)) return;
  if (dependency.reason() == Reason::Resource) {
    if (!from.began) ++(irreversible(dependency.to) ? state.commit_gate : state.start_gate);
    return;
  }
  if (dependency.reason() == Reason::Data && !irreversible(dependency.to) && !from.announced)
    ++state.start_gate;
  if (from.passed) {
    meet(dependency);
    return;
  }
  ++state.commit_gate;
  if (gates_start(dependency)) ++state.start_gate;
}

/// False if no node was appended.
bool ConcurrentEngine::Implementation::expand() {
  if (expansion_ == nullptr || limit_ != kNone) return false;
  const std::uint32_t first = network_.size();
  while (!expansion_->finished()) {
    const std::size_t unfinished = network_.size() - passed_count_;
    if (unfinished >= options_.horizon) break;
    const std::uint32_t before = network_.size();
    expansion_->expand(*growing_, options_.horizon - unfinished);
    if (network_.size() == before) break;
    builder_->extend();
    adopt();
  }
  return network_.size() > first;
}

/// Checks the nodes that something happened to, by rank; most come in that order anyway.
void ConcurrentEngine::Implementation::work_off() {
  const auto by_rank = [this](NodeId node) { return rank(node); };
  for (;;) {
    take_granted();
    take_waiting();
    preempt_for_waiting();
    note_unit_waits();
    if (work_.empty()) return;
    batch_.swap(work_);
    bool in_program_order = options_.priorities.empty();
    for (const NodeId node : batch_) {
      State& state = at(node);
      if (state.phase == Phase::Waiting) state.unlikely = unlikely(node);
      in_program_order = in_program_order && state.unlikely == 0;
    }
    if (!in_program_order)
      std::ranges::sort(batch_, {}, by_rank);
    else if (!std::ranges::is_sorted(batch_))
      std::ranges::sort(batch_);
    for (const NodeId node : batch_)
      check(node);
    batch_.clear();
  }
}

bool ConcurrentEngine::Implementation::complete() const {
  if (!running_.empty()) return false;
  if (limit_ != kNone) return prefix_ >= limit_;
  return passed_count_ == network_.size() && (expansion_ == nullptr || expansion_->finished());
}

/// Takes all ends at the next point in time; false if none can come.
bool ConcurrentEngine::Implementation::take_ends() {
  const auto counts = [this](const auto& end) {
    if (index(end.node) == kNone) return true;  // posted by wake()
    return index(end.node) < states_.size() && at(end.node).active && at(end.node).attempt == end.attempt;
  };
  const bool holds = hold();
  const bool awaited = holds || !running_.empty() || !unit_waits_.now().empty();
  auto first = events_.next(awaited, holds ? TimePoint::max() : patience_.deadline(), counts);
  if (!first) return give_up_lost() || events_.give_up_awaited();
  take_end(*first);
  while (auto end = events_.next_now(counts))
    take_end(*end);
  return true;
}

void ConcurrentEngine::Implementation::loop() {
  adopt();
  for (;;) {
    do {
      work_off();
    } while (!stop_asked_ && (expand() || take_lost()));
    if (complete()) return;
    if (!take_ends()) break;
  }
  const Error error = stall_error();
  failed_ = running_.empty() ? NodeId{prefix_} : running_.front();
  error_ = error;
}

void ConcurrentEngine::Implementation::stop() {
  stop_asked_ = true;
  wake();
}

void ConcurrentEngine::Implementation::pause(bool paused) {
  pause_.ask(paused);
  wake();
}

void ConcurrentEngine::Implementation::step() {
  pause_.ask_step();
  wake();
}

/// Makes the loop look at requests.
void ConcurrentEngine::Implementation::wake() {
  events_.finish(NodeId{kNone}, 0, nullptr);
}

void ConcurrentEngine::Implementation::heed_stop() {
  if (!stop_asked_ || !stop_asked_.exchange(false)) return;  // an exchange for each end would be slow
  stopped_ = true;
  truncate(NodeId{0});
}

/// Whether a pause keeps nodes from beginning. Says so once nothing runs any more.
bool ConcurrentEngine::Implementation::hold() {
  if (!pause_.paused() || ready_.empty()) return false;
  if (!running_.empty() || !options_.held || !pause_.tells()) return true;
  options_.held(ready_.all());
  return true;
}

RunResult ConcurrentEngine::Implementation::run() {
  events_.begin();
  for (const ResourceId resource : options_.limited)
    pool_.limit(resource, 0);
  heed_stop();
  pause_.take(stopped_);
  loop();
  return result();
}

RunResult ConcurrentEngine::Implementation::result() {
  RunResult result;
  result.failed = failed_;
  result.error = error_;
  result.stopped = stopped_;
  result.world = real_world(NodeId{static_cast<std::uint32_t>(states_.size())});
  for (std::uint32_t i = 0; i < network_.resources.size(); ++i)
    result.units.push_back(pool_.total(ResourceId{i}));
  result.nodes = std::move(results_);
  result.outputs.resize(states_.size());
  TimePoint last{};
  for (std::uint32_t i = 0; i < states_.size(); ++i) {
    const State& state = states_[i];
    NodeResult& node = result.nodes[i];
    node.outcome = state.outcome;
    node.attempts = state.attempt;
    if (state.phase == Phase::Skipped) node.status = NodeStatus::Skipped;
    if (state.phase != Phase::Done) continue;
    node.status = state.outcome == kPreempted ? NodeStatus::Preempted
                  : state.failed              ? NodeStatus::Failed
                                              : NodeStatus::Done;
    last = std::max(last, node.committed);
    if (reports_[i]) result.outputs[i] = reports_[i]->outputs;
  }
  result.makespan = last.time_since_epoch();
  result.own_time = events_.own_time();
  result.wasted = std::move(wasted_);
  result.unit_waits = unit_waits_.all();
  result.statistics = statistics_;
  result.statistics.looked_at = pool_.looked_at();
  result.log = std::move(log_);
  return result;
}

std::size_t ConcurrentEngine::Implementation::bytes() const {
  return states_.capacity() * sizeof(State) + results_.capacity() * sizeof(NodeResult) +
         reports_.capacity() * sizeof(ReportPtr) + reads_.capacity() + writes_.capacity() +
         versions_.capacity() * sizeof(std::uint32_t);
}

}  // namespace segue::task_network
