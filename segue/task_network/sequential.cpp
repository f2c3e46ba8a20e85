// SPDX-License-Identifier: Apache-2.0
#include "sequential.hpp"

#include <segue/task_network/node_outcome.hpp>

#include <algorithm>
#include <set>
#include <utility>

namespace segue::task_network {

namespace {

ReportPtr aborted(std::string why) {
  auto report = std::make_unique<Report>();
  report->outcome = kAborted;
  report->error = std::move(why);
  return report;
}

ReportPtr preempted() {
  auto report = std::make_unique<Report>();
  report->outcome = kPreempted;
  return report;
}

class SequentialRun {
 public:
  SequentialRun(const TaskNetwork& network, Environment& environment, ClockKind clock, std::stop_token stop)
      : network_(network), environment_(environment), events_(clock), stop_(std::move(stop)) {
    result_.world = network.initial_world;
    result_.nodes.resize(network.size());
    result_.outputs.resize(network.size());
    for (std::uint32_t i = 0; i < network.resources.size(); ++i) {
      result_.units.push_back(network.resources[ResourceId{i}].count);
      held_.push_back(0);
    }
    for (const GroupLock& group : network.groups())
      members_left_.push_back(group.members);
  }

  RunResult run() {
    const std::stop_callback wake(stop_, [this] { events_.finish(NodeId{kNone}, 0, nullptr); });
    for (std::uint32_t i = 0; i < network_.size() && !result_.failed && !result_.stopped; ++i) {
      result_.stopped = stop_.stop_requested();
      if (!result_.stopped) step(NodeId{i});
    }
    result_.makespan = events_.now().time_since_epoch();
    result_.own_time = events_.own_time();
    return std::move(result_);
  }

 private:
  class RunContext;

  [[nodiscard]] bool on_path(NodeId node) const {
    return std::ranges::all_of(network_.conditions(node), [&](const Condition& condition) {
      const NodeResult& other = result_.nodes[index(condition.node)];
      return other.status == NodeStatus::Done && other.outcome == condition.outcome;
    });
  }

  void step(NodeId node) {
    NodeResult& entry = result_.nodes[index(node)];
    if (!on_path(node)) {
      entry.status = NodeStatus::Skipped;
      leave_groups(node);
      return;
    }
    entry.started = events_.now();
    if (const Access* unmet = false_precondition(node)) {
      const Error why = precondition_error(network_, node, {unmet->fact, unmet->needed});
      return finish(node, refuse(node, why.message));
    }
    if (const auto missing = take(node)) return finish(node, refuse(node, missing->message));
    finish(node, execute(node));
  }

  [[nodiscard]] const Access* false_precondition(NodeId node) const {
    const auto accesses = network_.accesses(node);
    const auto found = std::ranges::find_if(accesses, [&](const Access& access) {
      return access.reads && !network_.facts.is_observed(access.fact) &&
             result_.world.holds(access.fact) != access.needed;
    });
    return found == accesses.end() ? nullptr : &*found;
  }

  void finish(NodeId node, const ReportPtr& report) {
    NodeResult& entry = result_.nodes[index(node)];
    entry.ended = entry.committed = events_.now();
    const NodeOutcome outcome = judge(network_, node, report.get());
    if (entry.attempts > 0) give_back(node, outcome.outcome == network_[node].expected);
    entry.outcome = outcome.outcome;
    if (report) result_.outputs[index(node)] = report->outputs;
    if (report) learn_units(*report);
    apply(node, outcome);
    leave_groups(node);
    if (outcome.failure && outcome.outcome == kPreempted && result_.stopped) {
      entry.status = NodeStatus::Preempted;
      return;
    }
    if (outcome.failure) return fail_with(node, *outcome.failure);
    entry.status = NodeStatus::Done;
  }

  void fail_with(NodeId node, const Error& error) {
    result_.nodes[index(node)].status =
        result_.nodes[index(node)].outcome == kPreempted ? NodeStatus::Preempted : NodeStatus::Failed;
    result_.failed = node;
    result_.error = error;
  }

  ReportPtr execute(NodeId node);
  ReportPtr refuse(NodeId node, const std::string& why);
  ReportPtr wait_for(NodeId node);

  void apply(NodeId node, const NodeOutcome& outcome) {
    if (outcome.as_declared) {
      for (const std::uint32_t place : network_.effects(node))
        result_.world.set({network_.access(place).fact, network_.access(place).value});
    }
    for (const Literal& literal : outcome.effects)
      result_.world.set(literal);
  }

  void learn_units(const Report& report) {
    for (const NamedUnits& named : report.named_units) {
      const auto resource = network_.resources.find(named.resource);
      if (!resource) continue;
      std::uint32_t& units = result_.units[index(*resource)];
      units = static_cast<std::uint32_t>(units + named.change);
    }
  }

  /// The units of one resource that a node's claims take now. The first member of a group takes the units of
  /// the whole group.
  [[nodiscard]] std::uint64_t wanted(std::span<const Claim> claims, ResourceId resource) const {
    std::uint64_t sum = 0;
    std::set<std::uint32_t> known;
    for (const Claim& claim : claims) {
      if (claim.resource != resource || claim.op == ResourceOp::Exists) continue;
      if (claim.group == kNone || known.insert(claim.group).second) sum += wanted(claim);
    }
    return sum;
  }

  [[nodiscard]] std::uint32_t wanted(const Claim& claim) const {
    if (claim.group != kNone)
      return groups_held_.contains(claim.group) ? 0 : network_.groups()[claim.group].count;
    return claim.op == ResourceOp::Create || claim.op == ResourceOp::Release ? 0 : claim.count;
  }

  std::optional<Error> take(NodeId node) {
    for (const Claim& claim : network_.claims(node)) {
      const std::uint32_t place = index(claim.resource);
      const bool exists = claim.group == kNone && claim.op == ResourceOp::Exists;
      const std::uint64_t units = exists ? claim.count : wanted(network_.claims(node), claim.resource);
      const std::uint64_t there = result_.units[place] - (exists ? 0 : held_[place]);
      if (units > there) return shortage_error(network_, node, claim, there);
    }
    for (const Claim& claim : network_.claims(node)) {
      const std::uint32_t place = index(claim.resource);
      if (claim.group != kNone) {
        held_[place] += wanted(claim);
        groups_held_.insert(claim.group);
      }
      if (claim.group == kNone && claim.op == ResourceOp::Consume) result_.units[place] -= claim.count;
    }
    return std::nullopt;
  }

  void give_back(NodeId node, bool done) {
    for (const Claim& claim : network_.claims(node)) {
      if (claim.group != kNone || !done) continue;
      if (claim.op == ResourceOp::Create) result_.units[index(claim.resource)] += claim.count;
      if (claim.op == ResourceOp::Delete) result_.units[index(claim.resource)] -= claim.count;
    }
  }

  void leave_groups(NodeId node) {
    for (const Claim& claim : network_.claims(node)) {
      if (claim.group == kNone || --members_left_[claim.group] > 0) continue;
      if (groups_held_.erase(claim.group) > 0)
        held_[index(claim.resource)] -= network_.groups()[claim.group].count;
    }
  }

  const TaskNetwork& network_;
  Environment& environment_;
  CompletionQueue events_;
  const std::stop_token stop_;
  RunResult result_;
  std::vector<std::uint32_t> held_;  ///< by resource: units that groups hold
  std::vector<std::uint32_t> members_left_;
  std::set<std::uint32_t> groups_held_;
};

class SequentialRun::RunContext final : public NodeContext {
 public:
  RunContext(const SequentialRun& run, NodeId node) : NodeContext(node, 1), run_(run) {}
  [[nodiscard]] const type::Value* input(std::uint32_t name) const override {
    const auto inputs = run_.network_.inputs(node());
    for (auto input = inputs.rbegin(); input != inputs.rend(); ++input) {
      if (input->input != name) continue;
      if (run_.result_.nodes[index(input->producer)].status == NodeStatus::Skipped) continue;
      const auto& outputs = run_.result_.outputs[index(input->producer)];
      return outputs ? outputs->find(run_.network_.names.name(input->output)) : nullptr;
    }
    return nullptr;
  }
  [[nodiscard]] bool holds(FactId fact) const override { return run_.result_.world.holds(fact); }
  [[nodiscard]] VersionedWorld world() override {
    asked_world_ = true;
    return run_.result_.world;
  }
  [[nodiscard]] std::uint32_t units(ResourceId resource) const override {
    return run_.result_.units[index(resource)];
  }
  [[nodiscard]] bool asked_world() const { return asked_world_; }

 private:
  const SequentialRun& run_;
  bool asked_world_ = false;
};

ReportPtr SequentialRun::execute(NodeId node) {
  RunContext context(*this, node);
  result_.nodes[index(node)].attempts = 1;
  ++result_.statistics.starts;
  environment_.start(context, events_);
  ReportPtr report = wait_for(node);
  environment_.ended(node, 1);
  if (context.asked_world() && !network_[node].reads_world &&
      network_[node].kind != ActionClass::Irreversible)
    return aborted("looked at the world without declaring reads_world");
  return report;
}

ReportPtr SequentialRun::refuse(NodeId node, const std::string& why) {
  RunContext context(*this, node);
  return environment_.refuse(context, why);
}

/// Waits for the end of the node. After a stop request the node is cancelled and has limited time to end.
ReportPtr SequentialRun::wait_for(NodeId node) {
  TimePoint deadline = TimePoint::max();
  for (;;) {
    const auto counts = [&](const auto& one) { return one.node == node || index(one.node) == kNone; };
    auto end = events_.next(true, deadline, counts);
    if (end && end->node == node) return std::move(end->report);
    if (!end) return preempted();
    if (std::exchange(result_.stopped, true)) continue;
    environment_.cancel(node, 1, events_);
    deadline = events_.elapsed() + environment_.patience();
  }
}

}  // namespace

RunResult run_sequential(const TaskNetwork& network, Environment& environment, ClockKind clock,
                         std::stop_token stop) {
  return SequentialRun(network, environment, clock, std::move(stop)).run();
}

}  // namespace segue::task_network
