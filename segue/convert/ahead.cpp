// SPDX-License-Identifier: Apache-2.0
#include <segue/cdtn/part.hpp>
#include <segue/convert/ahead.hpp>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace segue::convert {

using cdtn::NodeId;

namespace {

using cdtn::ActsAhead;

/// Nodes in the parts that are examined more closely; what would take more stays in the list.
constexpr std::size_t kMostCompared = 2'000'000;

/// Whether the input has several possible sources: a run waits only for those that may still count when it
/// plans the node.
bool has_candidates(const PlannedNode& node, std::uint32_t input) {
  const auto is_one_of_several = [&](const ValueSource& source) {
    return source.feeds.size() > 1 &&
           std::ranges::find(source.feeds, input, &ValueSource::Feed::input) != source.feeds.end();
  };
  const auto errors = [&](const BranchSource& branch) {
    return std::ranges::any_of(branch.ends, is_one_of_several, &BranchEnd::error);
  };
  return std::ranges::any_of(node.inputs, is_one_of_several) || is_one_of_several(node.error_before) ||
         is_one_of_several(node.begun) || std::ranges::any_of(node.branches, errors);
}

/// Whether a run certainly has the dependency. Of the ways that a join waits for, some may be known to be off
/// the path when a run plans what comes after; where the others are all ways from one state, it needs no
/// join.
bool is_certain(const MissionPlan& plan, NodeId to, const cdtn::Dependency& dependency) {
  if (dependency.reason() == cdtn::Reason::Condition) return true;
  if (plan[to].role == Role::Join) return false;
  return dependency.reason() != cdtn::Reason::Data || !has_candidates(plan[to], dependency.subject);
}

/// The paths of an outline. A run plans no node that it knows to be off its path, so only who is on the path
/// as well is certain to let others wait for what it waits for.
class OutlinePaths final : public cdtn::Paths {
 public:
  explicit OutlinePaths(const MissionPlan& plan) : plan_(plan) {}
  [[nodiscard]] bool implies(NodeId node, NodeId other) const override { return plan_.implies(node, other); }
  [[nodiscard]] bool comes_with(NodeId node, NodeId other) const override {
    return plan_.implies(node, other);
  }
  [[nodiscard]] bool is_certain(const cdtn::Dependency& dependency) const override {
    return convert::is_certain(plan_, dependency.to, dependency);
  }
  [[nodiscard]] bool exclude(NodeId a, NodeId b) const override {
    return plan_.exclude(a, b) || beside_or_after_race(plan_, b, a);
  }

 private:
  const MissionPlan& plan_;
};

/// The paths of a part all of whose nodes are on them.
class OnePath final : public cdtn::Paths {
 public:
  OnePath(const MissionPlan& plan, const cdtn::NetworkPart& part) : plan_(plan), part_(part) {}
  [[nodiscard]] bool implies(NodeId, NodeId) const override { return true; }
  [[nodiscard]] bool comes_with(NodeId, NodeId) const override { return true; }
  [[nodiscard]] bool is_certain(const cdtn::Dependency& dependency) const override {
    return convert::is_certain(plan_, part_.nodes[index(dependency.to)], dependency);
  }
  [[nodiscard]] bool exclude(NodeId a, NodeId b) const override {
    return beside_or_after_race(plan_, part_.nodes[index(b)], part_.nodes[index(a)]);
  }

 private:
  const MissionPlan& plan_;
  const cdtn::NetworkPart& part_;
};

/// Whether the node stands for a state that would execute something.
bool executes(const PlannedNode& node) {
  return (node.role == Role::Action || node.role == Role::OpaqueSubtree) && node.refused.empty();
}

/// Where a node is left out because it is off the path, others wait for each other directly. So of each two
/// conditions under which one may act although the other fails, that part of the plan is examined that is on
/// the path under both.
class CloserLook {
 public:
  explicit CloserLook(const MissionPlan& plan) : plan_(plan) {}

  void keep_true(std::vector<ActsAhead>& pairs) {
    std::map<Key, std::vector<ActsAhead>> groups;
    for (const ActsAhead& pair : pairs)
      groups[key(pair)].push_back(pair);
    std::vector<ActsAhead> kept;
    for (const auto& [conditions, group] : groups)
      examine(group, kept);
    std::ranges::sort(kept, {}, [](const ActsAhead& pair) { return std::pair(pair.acts, pair.fails); });
    pairs = std::move(kept);
  }

 private:
  using Key = std::array<std::uint32_t, 4>;
  [[nodiscard]] Key key(const ActsAhead& pair) const {
    const BranchEdge acts = plan_[pair.acts].when;
    const BranchEdge fails = plan_[pair.fails].when;
    return {acts.branch, static_cast<std::uint32_t>(acts.outcome), fails.branch,
            static_cast<std::uint32_t>(fails.outcome)};
  }

  void examine(const std::vector<ActsAhead>& group, std::vector<ActsAhead>& kept) {
    const ActsAhead& first = group.front();
    const std::uint32_t size = plan_.network().size();
    compared_ += size;
    if (compared_ > kMostCompared) {
      kept.insert(kept.end(), group.begin(), group.end());
      return;
    }
    std::vector<bool> keep(size);
    for (std::uint32_t i = 0; i < size; ++i)
      keep[i] = plan_.implies(first.acts, NodeId{i}) || plan_.implies(first.fails, NodeId{i});
    const cdtn::NetworkPart part = cdtn::part_of(plan_.network(), keep);
    for (const ActsAhead& pair :
         cdtn::acts_ahead(part.network, cdtn::derive_order(part.network), OnePath(plan_, part))) {
      const ActsAhead whole{part.nodes[index(pair.acts)], part.nodes[index(pair.fails)]};
      if (std::ranges::find(group, whole) != group.end()) kept.push_back(whole);
    }
  }

  const MissionPlan& plan_;
  std::size_t compared_ = 0;
};

}  // namespace

bool beside_or_after_race(const MissionPlan& plan, NodeId acts, NodeId fails) {
  const mission::Program& program = plan.program();
  for (const auto* branch = plan[fails].branch.get(); branch != nullptr; branch = branch->around.get()) {
    const mission::StateIndex container = program.node(branch->child).parent;
    if (program.node(container).kind != mission::StateKind::Preemptive) continue;
    const auto* own = plan[acts].branch.get();
    while (own != nullptr && own != branch)
      own = own->around.get();
    if (own == nullptr) return true;
  }
  return false;
}

Result<AheadOfFailures> ahead_of_failures(std::shared_ptr<const mission::Program> program,
                                          std::vector<type::Value> inputs,
                                          const std::vector<mission::Fact>& facts, std::size_t most) {
  const auto plan = MissionPlan::create(std::move(program), std::move(inputs), facts, PlanScope::Outline);
  if (!plan) return plan.error();
  (*plan)->expand((*plan)->network(), most);
  const cdtn::TaskNetwork& network = (*plan)->network();
  auto pairs = cdtn::acts_ahead(network, cdtn::derive_order(network), OutlinePaths(**plan));
  std::erase_if(pairs, [&](const ActsAhead& pair) { return !executes((**plan)[pair.acts]); });
  CloserLook(**plan).keep_true(pairs);
  return AheadOfFailures{cdtn::by_name(network, pairs), (*plan)->finished()};
}

}  // namespace segue::convert
