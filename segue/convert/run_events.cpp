// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/container_run.hpp>
#include <segue/convert/run_events.hpp>

#include <algorithm>
#include <utility>

namespace segue::convert {

using task_network::NodeId;
using task_network::NodeStatus;

namespace {

bool is_in(const ContainerRun& inner, const ContainerRun& outer) {
  const ContainerRun* around = inner.around.get();
  while (around != nullptr && around != &outer)
    around = around->around.get();
  return around != nullptr;
}

/// How many more units of its resource there are after a node, or fewer. `done`: it has ended as expected.
std::int64_t change_by(const task_network::Claim& claim, bool done) {
  using task_network::ResourceOp;
  const bool removes = claim.op == ResourceOp::Consume || (claim.op == ResourceOp::Delete && done);
  if (removes) return -std::int64_t{claim.count};
  return claim.op == ResourceOp::Create && done ? std::int64_t{claim.count} : 0;
}

}  // namespace

RunEvents::RunEvents(MissionPlan& plan, const RunOptions& options)
    : plan_(plan),
      observe_(options.observe),
      observe_units_(options.observe_units),
      can_be_resumed_(options.journal != nullptr),
      warn_(options.warn) {}

void RunEvents::begins(NodeId node, TimePoint now) {
  latest_ = now;
  note_units(node);
  if (!observe_) return;
  begin_containers(plan_.container_of(node));
  const PlannedNode& planned = plan_[node];
  if (planned.role == Role::Action) observe_({.path = planned.path, .iteration = planned.iteration});
}

/// Tells the begin of the containers, from the innermost on, in which nothing has begun before.
void RunEvents::begin_containers(std::shared_ptr<ContainerRun> innermost) {
  std::vector<std::shared_ptr<ContainerRun>> begun;
  for (; innermost != nullptr && !innermost->told; innermost = innermost->around)
    begun.push_back(innermost);
  for (auto around = begun.rbegin(); around != begun.rend(); ++around) {
    (*around)->told = true;
    begun_.push_back(*around);
    observe_({.path = (*around)->path, .iteration = (*around)->iteration, .is_container = true});
  }
}

void RunEvents::ended(NodeId node, task_network::OutcomeId outcome, const type::Value* outputs) {
  if (outcome == task_network::kPreempted) lost_.insert(node);
  tell_units(node, outcome, outputs);
  if (replayed_.erase(node) > 0) return;
  if (is_told(node, outcome)) tell_end(node, outcome, outputs);
}

void RunEvents::note_units(NodeId node) {
  const bool may_change = plan_[node].role == Role::OpaqueSubtree || !plan_.network().claims(node).empty();
  if (observe_units_ && may_change) using_units_.insert(node);
}

/// Tells once what the node has changed, which has begun.
void RunEvents::tell_units(NodeId node, task_network::OutcomeId outcome, const type::Value* outputs) {
  if (using_units_.erase(node) == 0) return;
  const task_network::TaskNetwork& network = plan_.network();
  mission::UnitChanges changes;
  for (const task_network::Claim& claim : network.claims(node)) {
    if (const auto change = change_by(claim, outcome == network[node].expected); change != 0)
      changes.emplace_back(network.resources.name(claim.resource), change);
  }
  const type::Value* record = outputs == nullptr ? nullptr : outputs->find(kRecordOutput);
  if (record != nullptr) {
    for (auto& change : mission::unit_changes(record->find("units")->as_map()))
      changes.push_back(std::move(change));
  }
  if (!changes.empty()) observe_units_({std::string(plan_[node].path), 0, plan_[node].loops}, changes);
}

/// Goes from the inner containers to the outer ones. A container that has lost a race has no exit that is
/// planned, and ends with the one around it.
void RunEvents::settle() {
  for (std::size_t i = begun_.size(); i-- > 0;) {
    const auto container = begun_[i];
    if (container->open > 0) continue;
    const bool is_off_path = plan_.off_path(*container);
    const auto end = is_off_path ? std::nullopt : plan_.end_of(*container);
    if (!is_off_path && !end) continue;
    begun_.erase(begun_.begin() + static_cast<std::ptrdiff_t>(i));
    if (is_off_path) continue;
    for (std::size_t inner = begun_.size(); inner-- > i;) {
      if (!is_in(*begun_[inner], *container)) continue;
      if (plan_.on_path(*begun_[inner])) tell_end(*begun_[inner], mission::kPreempted, {});
      begun_.erase(begun_.begin() + static_cast<std::ptrdiff_t>(inner));
    }
    tell_end(*container, end->outcome, end->error);
  }
}

/// Tells the ends that lead nowhere in the plan: those that ended the run.
void RunEvents::finish(const task_network::RunResult& result) {
  for (std::uint32_t i = 0; i < result.nodes.size(); ++i) {
    const NodeStatus status = result.nodes[i].status;
    if (status != NodeStatus::Failed && status != NodeStatus::Preempted) continue;
    const NodeId node{i};
    const type::Value* outputs = result.outputs[i].get();
    // Executions that are not in the journal begin again when the run is resumed.
    if (!can_be_resumed_ || !result.stopped) tell_units(node, result.nodes[i].outcome, outputs);
    if (const auto outcome = result.nodes[i].outcome; is_told(node, outcome) && !lost_.contains(node))
      tell_end(node, outcome, outputs);
    if (status == NodeStatus::Failed) tell_failed(node, result.error ? result.error->message : "");
  }
  settle();
  for (; !begun_.empty(); begun_.pop_back()) {
    if (plan_.on_path(*begun_.back())) tell_end(*begun_.back(), mission::kPreempted, {});
  }
}

/// An abort that nothing handles ends all containers around it.
void RunEvents::tell_failed(NodeId node, std::string_view error) {
  for (auto around = plan_.container_of(node); around != nullptr; around = around->around) {
    if (std::erase(begun_, around) > 0) tell_end(*around, mission::kAborted, error);
  }
}

/// An action, or a container that may not begin.
bool RunEvents::is_told(NodeId node, task_network::OutcomeId outcome) const {
  const Role role = plan_[node].role;
  return role == Role::Action || (role == Role::Begin && outcome == task_network::kAborted);
}

void RunEvents::tell_end(NodeId node, task_network::OutcomeId ending, const type::Value* outputs) {
  const PlannedNode& planned = plan_[node];
  const bool is_container = planned.role == Role::Begin;
  const mission::Outcome outcome = plan_.outcome(node, ending);
  const bool tries_again = retries_.ended(planned.state, outcome, latest_);
  if (!observe_ && !(tries_again && warn_)) return;
  const std::string path = is_container ? plan_.network().name_of(node) : std::string(planned.path);
  if (tries_again && warn_) warn_(path + ": " + mission::RetryWatch::warning());
  if (!observe_) return;
  const auto container = plan_.container_of(node);
  if (is_container && container) {  // the node is in the container that it begins
    begin_containers(container->around);
    container->told = true;
    std::erase(begun_, container);
  } else {
    begin_containers(container);
  }
  const std::string name = plan_.program().outcome_name(planned.state, outcome);
  const type::Value* error = outputs == nullptr ? nullptr : outputs->find(kErrorOutput);
  observe_({mission::StateEvent::Kind::Ended, path, planned.iteration, name,
            error == nullptr ? std::string_view{} : std::string_view(error->as_string()), is_container});
}

void RunEvents::tell_end(const ContainerRun& container, mission::Outcome outcome, std::string_view error) {
  const std::string name = plan_.program().outcome_name(container.state, outcome);
  observe_({mission::StateEvent::Kind::Ended, container.path, container.iteration, name, error, true});
}

}  // namespace segue::convert
