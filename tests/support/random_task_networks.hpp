// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_network/environment.hpp>
#include <segue/task_network/task_network.hpp>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

/// Random task networks, and a world in which what a node does depends on nothing but what it reads: for
/// tests only.
namespace segue::task_network {

inline std::uint64_t mix(std::uint64_t a, std::uint64_t b) {
  std::uint64_t number = a * 0x9E3779B97F4A7C15U + b + 0x7F4A7C15U;
  number = (number ^ (number >> 30)) * 0xBF58476D1CE4E5B9U;
  number = (number ^ (number >> 27)) * 0x94D049BB133111EBU;
  return number ^ (number >> 31);
}

/// What a random network may contain.
struct Variety {
  bool failures = false;            ///< nodes abort that nobody handles, preconditions are wrong
  bool undeclared_effects = false;  ///< nodes do what they do not declare
  bool parallel = false;            ///< nodes lie in parallel branches
};

class RandomNetwork {
 public:
  RandomNetwork(std::uint64_t seed, Variety variety) : random_(seed), variety_(variety) {
    other_ = network.outcome("other");
    for (int i = 0, facts = pick(1, 5); i < facts; ++i) {
      facts_.push_back(*network.facts.intern("f(" + std::to_string(i) + ")"));
      network.initial_world.set({facts_.back(), chance(50)});
    }
    expected_ = network.initial_world;
    for (int i = 0, resources = pick(1, 3); i < resources; ++i) {
      const ResourceId id = network.resources.intern("system:r" + std::to_string(i));
      network.resources[id].count = static_cast<std::uint32_t>(pick(1, 3));
      network.resources[id].commutes = chance(30);
      units_.push_back(network.resources[id].count);
    }
    if (variety.parallel && mix(seed, 11) % 2 == 0) add_branches();
    network.effects_are_declared = !variety.undeclared_effects && mix(seed, 12) % 2 == 0;
    for (int i = 0, nodes = pick(1, 16); i < nodes; ++i)
      add_node(i);
  }

  TaskNetwork network;

 private:
  int pick(int least, int most) { return std::uniform_int_distribution<int>(least, most)(random_); }
  bool chance(int percent) { return pick(1, 100) <= percent; }

  /// Two in parallel, and two more in one of these.
  void add_branches() {
    for (int i = 0; i < 2; ++i)
      branches_.push_back(network.add_parallel_branch(kNone, 0));
    for (int i = 0; i < 2; ++i)
      branches_.push_back(network.add_parallel_branch(branches_.front(), 1));
    branches_.push_back(kNone);
  }

  void add_node(int number) {
    NodeSpec spec;
    if (!branches_.empty()) spec.parallel_branch = branches_[static_cast<std::size_t>(pick(0, 4))];
    spec.name = "n" + std::to_string(number);
    const int kind = pick(0, 9);
    spec.kind = kind < 5 ? ActionClass::Irreversible : kind < 8 ? ActionClass::Pure : ActionClass::Sensing;
    spec.uncertain = chance(20);
    spec.opaque = spec.kind == ActionClass::Irreversible && chance(5);
    spec.reads_world = spec.kind == ActionClass::Pure && chance(10);
    if (chance(30)) {
      spec.branches = true;
      spec.handles_abort = chance(30);
      if (chance(30)) spec.expected = other_;
    }
    spec.strict = chance(5);
    add_conditions(spec);
    add_facts(spec);
    add_claims(spec);
    spec.cannot_fail = !variety_.failures && spec.preconditions.empty() && spec.claims.empty() && chance(60);
    for (int i = 0, inputs = number == 0 ? 0 : pick(0, 2); i < inputs; ++i) {
      spec.inputs.push_back({NodeId(static_cast<std::uint32_t>(pick(0, number - 1))),
                             network.names.intern("out"),
                             network.names.intern("in" + std::to_string(pick(0, 1)))});
    }
    network.append(spec);
  }

  void add_conditions(NodeSpec& spec) {
    for (std::uint32_t i = 0; i < network.size(); ++i) {
      if (!network[NodeId{i}].branches || !chance(25)) continue;
      OutcomeId outcome = chance(60) ? network[NodeId{i}].expected : chance(50) ? kSuccess : other_;
      if (network[NodeId{i}].handles_abort && chance(25)) outcome = kAborted;
      const auto likelihood =
          chance(50) ? Condition::kCertain : static_cast<std::uint16_t>(pick(0, 9) * 6553);
      spec.conditions.push_back({NodeId{i}, outcome, likelihood});
    }
  }

  void add_facts(NodeSpec& spec) {
    for (const FactId fact : facts_) {
      const bool likely = expected_.holds(fact);
      if (chance(25)) spec.preconditions.push_back({fact, variety_.failures && chance(5) ? !likely : likely});
      if (chance(20)) spec.effects.push_back({fact, chance(50)});
    }
    for (const Literal& effect : spec.effects)
      expected_.set(effect);
  }

  void add_claims(NodeSpec& spec) {
    if (group_ != kNone && chance(60)) {
      --group_left_;
      spec.claims.push_back(
          {group_resource_, chance(70) ? ResourceOp::Block : ResourceOp::Release, 1, group_});
    }
    for (std::uint32_t i = 0; i < units_.size(); ++i) {
      const ResourceId id{i};
      if (!chance(25) || (group_ != kNone && id == group_resource_)) continue;
      add_claim(spec, id);
      if (chance(10)) add_claim(spec, id);
    }
    if (group_left_ == 0) group_ = kNone;
    if (group_ == kNone && spec.claims.empty() && chance(10)) {
      group_resource_ = ResourceId(static_cast<std::uint32_t>(pick(0, static_cast<int>(units_.size()) - 1)));
      group_ = network.add_group(group_resource_, 1);
      group_left_ = pick(1, 3);
      spec.claims.push_back({group_resource_, ResourceOp::Block, 1, group_});
    }
  }

  void add_claim(NodeSpec& spec, ResourceId id) {
    std::uint32_t& units = units_[index(id)];
    const int kind = pick(0, 9);
    if (variety_.failures && chance(4)) {
      spec.claims.push_back({id, chance(70) ? ResourceOp::Block : ResourceOp::Exists, units + 1});
      return;
    }
    if (units == 0) return;
    if (kind < 6) {
      spec.claims.push_back(
          {id, ResourceOp::Block, static_cast<std::uint32_t>(pick(1, static_cast<int>(units)))});
    } else if (kind < 8) {
      spec.claims.push_back({id, ResourceOp::Exists, 1});
    } else if (kind == 8 && spec.conditions.empty()) {
      spec.claims.push_back({id, ResourceOp::Create, 1});
    } else if (kind == 9 && units > 1) {
      spec.claims.push_back({id, chance(50) ? ResourceOp::Consume : ResourceOp::Delete, 1});
      --units;
    }
  }

  std::mt19937_64 random_;
  Variety variety_;
  OutcomeId other_{};
  std::vector<FactId> facts_;
  std::vector<std::uint32_t> branches_;
  VersionedWorld expected_;           ///< where everything goes as expected
  std::vector<std::uint32_t> units_;  ///< that are certainly there
  std::uint32_t group_ = kNone;
  int group_left_ = 0;
  ResourceId group_resource_{};
};

/// How long things take. Unsteady: each run of a node its own time, and who is cancelled need not care.
/// Steady: each node its time, and who is cancelled ends at once.
enum class Pace : std::uint8_t { Unsteady, Steady };

/// Answers are a function of the node and of the values that it reads; how long anything takes is not.
class RandomEnvironment final : public Environment {
 public:
  RandomEnvironment(const TaskNetwork& network, std::uint64_t answers, Variety variety,
                    std::uint64_t schedule, Pace pace = Pace::Unsteady)
      : network_(network), answers_(answers), variety_(variety), schedule_(schedule), pace_(pace) {}

  /// How often a node may begin; `exceeded` is called where one does so more often, each time.
  void limit_attempts(std::uint32_t most, std::function<void()> exceeded) {
    most_attempts_ = most;
    exceeded_ = std::move(exceeded);
  }

  void start(NodeContext& context, Completions& completions) override {
    if (exceeded_ && context.attempt() > most_attempts_) exceeded_();
    const std::uint64_t run = pace_ == Pace::Steady ? 1 : context.attempt();
    const std::uint64_t when = mix(mix(schedule_, index(context.node())), run);
    const TimePoint end = completions.now() + std::chrono::seconds(when % 3 == 0 ? 0 : when / 3 % 20);
    completions.finish_at(end, context.node(), context.attempt(), report(context));
  }

  void cancel(NodeId node, std::uint32_t attempt, Completions& completions) override {
    const std::uint64_t how = pace_ == Pace::Steady ? 1 : mix(mix(schedule_, attempt), index(node) + 1000);
    if (how % 4 == 0) return;  // it does not care
    auto report = std::make_unique<Report>();
    report->outcome = kPreempted;
    completions.finish_at(completions.now() + std::chrono::seconds(how / 4 % 3), node, attempt,
                          std::move(report));
  }

 private:
  [[nodiscard]] std::uint64_t digest(NodeContext& context) const {
    const NodeId node = context.node();
    std::uint64_t digest = mix(answers_, index(node));
    for (const Access& access : network_.accesses(node)) {
      if (access.reads) digest = mix(digest, context.holds(access.fact) ? 2 : 1);
    }
    for (const char* name : {"in0", "in1"}) {
      const auto number = network_.names.find(name);
      const type::Value* value = number ? context.input(*number) : nullptr;
      digest = mix(digest, value == nullptr ? 7 : value->as_uint());
    }
    if (network_[node].reads_world) {
      for (const FactId fact : context.world().facts())
        digest = mix(digest, index(fact));
    }
    return digest;
  }

  ReportPtr report(NodeContext& context) const {
    const NodeRecord& node = network_[context.node()];
    const std::uint64_t number = digest(context);
    auto report = std::make_unique<Report>();
    report->outcome = node.expected;
    if (node.branches) {
      if (number % 3 == 0) report->outcome = OutcomeId(number / 3 % 2 == 0 ? 0 : 3);
      if (node.handles_abort && number % 5 == 0) report->outcome = kAborted;
    }
    if (variety_.failures && !node.cannot_fail && mix(number, 3) % 40 == 0) report->outcome = kAborted;
    if (node.uncertain) report->effects = otherwise(context.node(), number);
    if (node.opaque)
      (report->effects ? *report->effects : report->effects.emplace()).push_back(anything(number));
    if (variety_.undeclared_effects && mix(number, 4) % 40 == 0) report->effects = {{anything(number)}};
    // Few different outputs, so that a repeated node often gives the same again.
    report->outputs =
        std::make_shared<type::Value>(type::Value::map({{"out", mix(number, 5) % 3}, {"all", number}}));
    return report;
  }

  [[nodiscard]] Literal anything(std::uint64_t number) const {
    return {FactId(static_cast<std::uint32_t>(mix(number, 6) % network_.facts.size())),
            mix(number, 7) % 2 == 0};
  }

  [[nodiscard]] std::vector<Literal> otherwise(NodeId node, std::uint64_t number) const {
    std::vector<Literal> effects;
    for (const Access& access : network_.accesses(node)) {
      const std::uint64_t how = mix(number, 10 + index(access.fact)) % 4;
      if (access.writes && how > 0) effects.push_back({access.fact, how == 1 ? !access.value : access.value});
    }
    return effects;
  }

  std::uint32_t most_attempts_ = 0;
  std::function<void()> exceeded_{};
  const TaskNetwork& network_;
  std::uint64_t answers_;
  Variety variety_;
  std::uint64_t schedule_;
  Pace pace_;
};

}  // namespace segue::task_network
