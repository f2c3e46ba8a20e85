// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/ahead_of_failures.hpp>
#include <segue/convert/mission_plan.hpp>
#include <segue/convert/race_order.hpp>
#include <segue/task_network/part.hpp>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace segue::convert {

using task_network::NodeId;

namespace {

using task_network::ActsAhead;

/// The most nodes in the parts that are examined more closely; pairs that would need more stay in the list.
constexpr std::size_t kMostCompared = 2'000'000;

/// The source of a value to which the input belongs; null for inputs that are not part of values.
const ValueSource* source_of(const PlannedNode& node, std::uint32_t input) {
  const auto feeds = [&](const ValueSource& source) {
    return std::ranges::find(source.feeds, input, &ValueSource::Feed::input) != source.feeds.end();
  };
  if (feeds(node.error_before)) return &node.error_before;
  if (feeds(node.passed_on)) return &node.passed_on;
  for (const BranchSource& branch : node.branches) {
    const auto end = std::ranges::find_if(branch.ends, feeds, &BranchEnd::error);
    if (end != branch.ends.end()) return &end->error;
  }
  const auto found = std::ranges::find_if(node.inputs, feeds);
  return found == node.inputs.end() ? nullptr : &*found;
}

/// Whether a run certainly has the dependency. A join waits for several ways; some of them may be known to be
/// off the path when a run plans what comes after, and where the others are all ways from one state, the run
/// needs no join. Where a value has several possible sources, a run waits only for those that may still
/// count; on one path that is the newest: `counts` tells whether a source is on the path.
template <class Counts>
bool is_certain(const PlannedNode& to, const task_network::Dependency& dependency, Counts&& counts) {
  if (dependency.reason() == task_network::Reason::Condition) return true;
  if (to.role == Role::Join) return false;
  if (dependency.reason() != task_network::Reason::Data) return true;
  const ValueSource* source = source_of(to, dependency.subject);
  if (source == nullptr || source->feeds.size() == 1) return true;
  const auto newest = std::ranges::find_if(source->feeds, counts, &ValueSource::Feed::input);
  return newest != source->feeds.end() && newest->input == dependency.subject;
}

/// Whether a run certainly has a dependency because of a fact. A node that makes a fact true that is known to
/// be true already changes nothing: nobody waits for that node, nor does it wait for nodes that rely on the
/// fact. Whether the fact is known depends on which other nodes are on the path.
class FactOrder {
 public:
  FactOrder(const MissionPlan& plan, const PathIndex& paths) : plan_(plan), paths_(paths) {}

  /// `is_there` tells whether a node is on the path of every run that has both.
  template <class IsThere>
  [[nodiscard]] bool is_certain(NodeId from, NodeId to, std::uint32_t fact, IsThere&& is_there) const {
    const task_network::Access* first = last_access(from, fact);
    const task_network::Access* second = last_access(to, fact);
    if (first == nullptr || second == nullptr) return true;
    if (first->writes) {
      const bool opposite = second->writes ? second->value != first->value : second->needed != first->value;
      return opposite || surely_changes(*first, to, is_there);
    }
    // A node that needs the opposite of the value to which it sets the fact is refused if the fact has that
    // value already, and does not act.
    const bool refused_else = second->reads && second->needed != second->value;
    return second->writes && (refused_else || surely_changes(*second, from, is_there));
  }

 private:
  [[nodiscard]] const task_network::Access* last_access(NodeId node, std::uint32_t fact) const {
    const auto accesses = plan_.network().accesses(node);
    const auto found = std::ranges::find(accesses.rbegin(), accesses.rend(), task_network::FactId{fact},
                                         &task_network::Access::fact);
    return found == accesses.rend() ? nullptr : &*found;
  }

  /// Whether the fact has the other value before the access, whatever path leads there and to the other node.
  template <class IsThere>
  [[nodiscard]] bool surely_changes(const task_network::Access& access, NodeId other,
                                    IsThere&& is_there) const {
    const task_network::TaskNetwork& network = plan_.network();
    for (std::uint32_t i = access.previous_write; i != task_network::kNone;
         i = network.access(i).previous_write) {
      const task_network::Access& before = network.access(i);
      if (network.in_parallel(before.node, access.node)) continue;
      const BranchEdge when = plan_[before.node].when;
      if (paths_.never_meet(when, plan_[access.node].when) || paths_.never_meet(when, plan_[other].when))
        continue;
      if (network[before.node].uncertain || before.value == access.value) return false;
      if (is_there(before.node)) return true;
    }
    return network.initial_world.holds(access.fact) != access.value;
  }

  const MissionPlan& plan_;
  const PathIndex& paths_;
};

/// The paths of an outline. A run plans no node that it knows to be off its path, so only nodes that are on
/// the path as well are certain to let others wait for the nodes that they wait for.
class OutlinePaths final : public task_network::Paths {
 public:
  OutlinePaths(const MissionPlan& plan, const PathIndex& paths) : plan_(plan), paths_(paths) {}
  [[nodiscard]] bool implies(NodeId node, NodeId other) const override {
    return paths_.implies(plan_[node].when, plan_[other].when);
  }
  [[nodiscard]] bool comes_with(NodeId node, NodeId other) const override { return implies(node, other); }
  [[nodiscard]] bool is_certain(const task_network::Dependency& dependency) const override {
    if (dependency.reason() == task_network::Reason::Fact) {
      return FactOrder(plan_, paths_)
          .is_certain(dependency.from, dependency.to, dependency.subject, [&](NodeId node) {
            return implies(dependency.from, node) || implies(dependency.to, node);
          });
    }
    return convert::is_certain(plan_[dependency.to], dependency, [](std::uint32_t) { return false; });
  }
  [[nodiscard]] bool exclude(NodeId a, NodeId b) const override {
    return paths_.never_meet(plan_[a].when, plan_[b].when) || beside_or_after_race(plan_, b, a);
  }

 private:
  const MissionPlan& plan_;
  const PathIndex& paths_;
};

/// The paths of a part all of whose nodes are on them.
class OnePath final : public task_network::Paths {
 public:
  OnePath(const MissionPlan& plan, const PathIndex& paths, const task_network::NetworkPart& part)
      : plan_(plan), paths_(paths), part_(part) {}
  [[nodiscard]] bool implies(NodeId, NodeId) const override { return true; }
  [[nodiscard]] bool comes_with(NodeId, NodeId) const override { return true; }
  [[nodiscard]] bool is_certain(const task_network::Dependency& dependency) const override {
    if (dependency.reason() == task_network::Reason::Fact) {
      return FactOrder(plan_, paths_)
          .is_certain(part_.nodes[index(dependency.from)], part_.nodes[index(dependency.to)],
                      dependency.subject,
                      [&](NodeId node) { return std::ranges::binary_search(part_.nodes, node); });
    }
    const auto inputs = part_.network.inputs(dependency.to);
    const auto is_there = [&](std::uint32_t input) {
      return std::ranges::find(inputs, input, &task_network::DataInput::input) != inputs.end();
    };
    return convert::is_certain(plan_[part_.nodes[index(dependency.to)]], dependency, is_there);
  }
  [[nodiscard]] bool exclude(NodeId a, NodeId b) const override {
    return beside_or_after_race(plan_, part_.nodes[index(b)], part_.nodes[index(a)]);
  }

 private:
  const MissionPlan& plan_;
  const PathIndex& paths_;
  const task_network::NetworkPart& part_;
};

/// Whether the node stands for a state that would execute something.
bool executes(const PlannedNode& node) {
  return (node.role == Role::Action || node.role == Role::OpaqueSubtree) && node.refused.empty();
}

/// Where a node is left out because it is off the path, others wait for each other directly. Each pair of
/// conditions, under which one node may act although the other fails, is examined in the part of the plan
/// that is on the path under both.
class CloserLook {
 public:
  CloserLook(const MissionPlan& plan, const PathIndex& paths) : plan_(plan), paths_(paths) {}

  /// `pairs`: by `acts`, then `fails`.
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
  /// Both conditions; where one implies the other, only that.
  [[nodiscard]] Key key(const ActsAhead& pair) const {
    BranchEdge acts = plan_[pair.acts].when;
    BranchEdge fails = plan_[pair.fails].when;
    if (paths_.implies(acts, fails)) {
      fails = {};
    } else if (paths_.implies(fails, acts)) {
      acts = {};
    }
    return {acts.branch, static_cast<std::uint32_t>(acts.outcome), fails.branch,
            static_cast<std::uint32_t>(fails.outcome)};
  }

  void examine(const std::vector<ActsAhead>& group, std::vector<ActsAhead>& kept) {
    const std::uint32_t size = index(group.back().acts) + 1;  // what comes later changes nothing
    compared_ += size;
    if (compared_ > kMostCompared) {
      kept.insert(kept.end(), group.begin(), group.end());
      return;
    }
    const task_network::NetworkPart part = part_on_path(group.front(), size);
    std::vector<NodeId> acting;  // in the part
    for (const ActsAhead& pair : group) {
      const NodeId place{
          static_cast<std::uint32_t>(std::ranges::lower_bound(part.nodes, pair.acts) - part.nodes.begin())};
      if (acting.empty() || acting.back() != place) acting.push_back(place);
    }
    for (const ActsAhead& pair : task_network::acts_ahead(
             part.network, task_network::derive_order(part.network), OnePath(plan_, paths_, part), acting)) {
      const ActsAhead whole{part.nodes[index(pair.acts)], part.nodes[index(pair.fails)]};
      const auto in_program_order = [](const ActsAhead& one) { return std::pair(one.acts, one.fails); };
      if (std::ranges::binary_search(group, in_program_order(whole), {}, in_program_order))
        kept.push_back(whole);
    }
  }

  /// The nodes among the first `size` that are on the path under both conditions of the pair.
  [[nodiscard]] task_network::NetworkPart part_on_path(const ActsAhead& pair, std::uint32_t size) const {
    const BranchEdge acts = plan_[pair.acts].when;
    const BranchEdge fails = plan_[pair.fails].when;
    std::vector<bool> keep(plan_.network().size());
    for (std::uint32_t i = 0; i < size; ++i) {
      const BranchEdge when = plan_[NodeId{i}].when;
      keep[i] = paths_.implies(acts, when) || paths_.implies(fails, when);
    }
    return task_network::part_of(plan_.network(), keep);
  }

  const MissionPlan& plan_;
  const PathIndex& paths_;
  std::size_t compared_ = 0;
};

}  // namespace

Result<AheadOfFailures> ahead_of_failures(std::shared_ptr<const mission::Program> program,
                                          std::vector<type::Value> inputs,
                                          const std::vector<mission::Fact>& facts, std::size_t most) {
  const auto plan = MissionPlan::create(std::move(program), std::move(inputs), facts, PlanScope::Outline);
  if (!plan) return plan.error();
  (*plan)->expand((*plan)->network(), most);
  const task_network::TaskNetwork& network = (*plan)->network();
  const PathIndex paths = (*plan)->path_index();
  const task_network::Order order = task_network::derive_order(network);
  const OutlinePaths outline(**plan, paths);
  auto pairs = task_network::acts_ahead(network, order, outline);
  std::erase_if(pairs, [&](const ActsAhead& pair) { return !executes((**plan)[pair.acts]); });
  CloserLook(**plan, paths).keep_true(pairs);
  auto senses = task_network::senses_ahead(network, order, outline);
  std::erase_if(senses, [&](const task_network::SensesAhead& pair) {
    return !executes((**plan)[pair.senses]) || !executes((**plan)[pair.acts]);
  });
  return AheadOfFailures{task_network::by_name(network, pairs), task_network::by_name(network, senses),
                         (*plan)->finished()};
}

}  // namespace segue::convert
