// SPDX-License-Identifier: Apache-2.0
#include "acts_ahead.hpp"

#include <algorithm>
#include <set>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace segue::task_network {

namespace {

/// Whether the run ends where this node aborts.
bool may_end_the_run(const NodeRecord& node) {
  return !node.cannot_fail && !(node.branches && node.handles_abort);
}

bool changes_units(const Claim& claim) {
  return claim.op == ResourceOp::Create || claim.op == ResourceOp::Consume || claim.op == ResourceOp::Delete;
}

/// Finds what a node is certain to have waited for by following its dependencies backwards: what has passed
/// has waited for its own.
class AheadFinder {
 public:
  AheadFinder(const TaskNetwork& network, const Order& order, const Paths& paths)
      : network_(network),
        order_(order),
        paths_(paths),
        passed_(network.size(), kNone),
        followed_(network.size(), kNone) {}

  std::vector<ActsAhead> find(std::span<const NodeId> nodes) {
    std::vector<ActsAhead> pairs;
    for (const NodeId node : nodes) {
      if (network_[node].strict || !acts(network_, node)) continue;
      follow(node);
      for (std::uint32_t j = first_; j < index(node); ++j) {
        const NodeId earlier{j};
        const bool waited = passed_[j] == index(node) || !may_end_the_run(network_[earlier]);
        if (!waited && !paths_.exclude(earlier, node)) pairs.push_back({node, earlier});
      }
    }
    return pairs;
  }

 private:
  void follow(NodeId node) {
    node_ = node;
    first_ = index(node) > kAheadWithin ? index(node) - kAheadWithin : 0;
    aside_.clear();
    open_.assign(1, node);
    while (!open_.empty()) {
      const NodeId at = open_.back();
      open_.pop_back();
      for (const Dependency& dependency : order_.before(at))
        take(dependency);
    }
  }

  /// A node that writes a fact may turn out to leave it as it is. Then nobody waits for that node because of
  /// the fact, but for the nodes for which it waits because of the fact.
  void take_those_of_fact(const Dependency& dependency) {
    std::vector<NodeId> open{dependency.from};
    while (!open.empty()) {
      const NodeId at = open.back();
      open.pop_back();
      if (index(at) < first_ || !aside_.emplace(index(at), dependency.subject).second) continue;
      for (const Dependency& before : order_.before(at)) {
        if (before.reason() != Reason::Fact || before.subject != dependency.subject) continue;
        if (!writes(before.from, FactId{before.subject})) continue;
        if (paths_.is_certain(before))
          take(before);
        else
          open.push_back(before.from);
      }
    }
  }

  [[nodiscard]] bool writes(NodeId node, FactId fact) const {
    return std::ranges::any_of(network_.accesses(node),
                               [&](const Access& access) { return access.fact == fact && access.writes; });
  }

  /// A dependency because of a resource says only that the other has begun. A node that begins has waited for
  /// all that a node which has passed has waited for, since nodes that take units in program order never run
  /// speculatively.
  void take(const Dependency& dependency) {
    const std::uint32_t from = index(dependency.from);
    if (from < first_) return;
    if (!paths_.is_certain(dependency)) {
      if (dependency.reason() == Reason::Fact) take_those_of_fact(dependency);
      return;
    }
    if (dependency.reason() != Reason::Resource) passed_[from] = index(node_);
    if (followed_[from] == index(node_) || !paths_.comes_with(node_, dependency.from)) return;
    followed_[from] = index(node_);
    const NodeRecord& other = network_[dependency.from];
    const bool held = other.strict && other.kind == ActionClass::Irreversible;
    if (held && paths_.implies(node_, dependency.from)) pass_before_strict(dependency.from);
    open_.push_back(dependency.from);
  }

  /// A strict node has waited for all before it but those in parallel branches.
  void pass_before_strict(NodeId strict) {
    if (network_[strict].parallel_branch == kNone) {
      first_ = std::max(first_, index(strict));
      return;
    }
    for (std::uint32_t j = first_; j < index(strict); ++j)
      if (!network_.in_parallel(NodeId{j}, strict)) passed_[j] = index(node_);
  }

  const TaskNetwork& network_;
  const Order& order_;
  const Paths& paths_;
  std::vector<std::uint32_t> passed_;    ///< by node: the last for which it has passed
  std::vector<std::uint32_t> followed_;  ///< by node: the last whose dependencies have been followed
  std::vector<NodeId> open_;
  std::set<std::pair<std::uint32_t, std::uint32_t>>
      aside_;  ///< nodes and facts that they may leave as they are
  NodeId node_{};
  std::uint32_t first_ = 0;  ///< nodes before are certain to have passed, or too far away
};

}  // namespace

bool acts(const TaskNetwork& network, NodeId node) {
  const NodeRecord& entry = network[node];
  if (entry.kind == ActionClass::Irreversible) return true;
  if (entry.reads_world) return false;  // it counts once all before it have passed
  return std::ranges::any_of(network.accesses(node), [](const Access& access) { return access.writes; }) ||
         std::ranges::any_of(network.claims(node), changes_units);
}

namespace {

/// The conditions that must be true for the node to be on the path: its own, and those of the nodes that they
/// name.
std::set<Condition> all_conditions(const TaskNetwork& network, NodeId node) {
  std::set<Condition> known;
  std::vector<NodeId> open{node};
  while (!open.empty()) {
    const NodeId at = open.back();
    open.pop_back();
    for (const Condition& condition : network.conditions(at)) {
      if (known.insert(condition).second) open.push_back(condition.node);
    }
  }
  return known;
}

}  // namespace

bool WholeNetwork::implies(NodeId node, NodeId other) const {
  const auto own = all_conditions(network_, node);
  const auto wanted = all_conditions(network_, other);
  return std::ranges::includes(own, wanted);
}

bool WholeNetwork::exclude(NodeId a, NodeId b) const {
  if (network_.conditions(a).empty() || network_.conditions(b).empty()) return false;
  const auto first = all_conditions(network_, a);
  const auto second = all_conditions(network_, b);
  return std::ranges::any_of(second, [&](const Condition& condition) {
    const auto other = first.lower_bound({condition.node, OutcomeId{}});
    const bool same_node = other != first.end() && other->node == condition.node;
    return same_node && !first.contains(condition);
  });
}

std::vector<ActsAhead> acts_ahead(const TaskNetwork& network, const Order& order, const Paths& paths) {
  std::vector<NodeId> all;
  for (std::uint32_t i = 0; i < order.size(); ++i)
    all.push_back(NodeId{i});
  return acts_ahead(network, order, paths, all);
}

std::vector<ActsAhead> acts_ahead(const TaskNetwork& network, const Order& order, const Paths& paths,
                                  std::span<const NodeId> nodes) {
  return AheadFinder(network, order, paths).find(nodes);
}

namespace {

/// Finds the nodes that a node which has begun is certain to have waited for. A node that runs ahead waits
/// for less than one that counts: neither for decisions, nor for nodes that only predict the outputs that it
/// takes.
class SensedFinder {
 public:
  SensedFinder(const TaskNetwork& network, const Order& order, const Paths& paths)
      : network_(network),
        order_(order),
        paths_(paths),
        passed_(network.size(), kNone),
        begun_(network.size(), kNone),
        followed_(network.size(), kNone) {}

  std::vector<SensesAhead> find() {
    std::vector<SensesAhead> pairs;
    for (std::uint32_t i = 0; i < order_.size(); ++i) {
      const NodeId node{i};
      if (network_[node].kind != ActionClass::Sensing) continue;
      follow(node);
      for (std::uint32_t j = first_; j < i; ++j) {
        const NodeId earlier{j};
        const bool acts =
            network_[earlier].kind == ActionClass::Irreversible && !network_[earlier].structural;
        if (acts && passed_[j] != i && !network_.in_parallel(earlier, node) && !paths_.exclude(earlier, node))
          pairs.push_back({node, earlier});
      }
    }
    return pairs;
  }

 private:
  void follow(NodeId node) {
    node_ = node;
    first_ = index(node) > kAheadWithin ? index(node) - kAheadWithin : 0;
    begun_list_.assign(1, node);
    while (!begun_list_.empty()) {
      const NodeId at = begun_list_.back();
      begun_list_.pop_back();
      for (const Dependency& dependency : order_.before(at))
        if (is_known(dependency)) before_begin(dependency);
    }
    while (!passed_list_.empty()) {
      const NodeId at = passed_list_.back();
      passed_list_.pop_back();
      for (const Dependency& dependency : order_.before(at))
        if (is_known(dependency)) before_end(dependency);
    }
  }

  [[nodiscard]] bool is_known(const Dependency& dependency) const {
    return index(dependency.from) >= first_ && paths_.is_certain(dependency);
  }

  /// Whether it begins only when all that it depends on has happened.
  [[nodiscard]] bool never_runs_ahead(NodeId node) const {
    return network_[node].kind == ActionClass::Irreversible || network_.observes(node) ||
           std::ranges::any_of(network_.claims(node), [this](const Claim& claim) {
             const ResourceRecord& resource = network_.resources[claim.resource];
             return resource.varies || resource.grouped;
           });
  }

  void before_begin(const Dependency& dependency) {
    if (!never_runs_ahead(dependency.to) && !holds_start(network_, dependency)) return;
    const bool may_be_ahead = network_[dependency.from].kind != ActionClass::Irreversible;
    const bool has_only_run = dependency.reason() == Reason::Data || dependency.reason() == Reason::Resource;
    if (!has_only_run || !may_be_ahead) return before_end(dependency);
    const std::uint32_t from = index(dependency.from);
    if (begun_[from] == index(node_) || !paths_.comes_with(node_, dependency.from)) return;
    begun_[from] = index(node_);
    begun_list_.push_back(dependency.from);
  }

  /// A dependency because of a resource says only that the other has begun.
  void before_end(const Dependency& dependency) {
    const std::uint32_t from = index(dependency.from);
    if (dependency.reason() != Reason::Resource) passed_[from] = index(node_);
    if (followed_[from] == index(node_) || !paths_.comes_with(node_, dependency.from)) return;
    followed_[from] = index(node_);
    passed_list_.push_back(dependency.from);
  }

  const TaskNetwork& network_;
  const Order& order_;
  const Paths& paths_;
  std::vector<std::uint32_t> passed_;    ///< by node: the last for which it has passed
  std::vector<std::uint32_t> begun_;     ///< by node: the last whose begin dependencies have been followed
  std::vector<std::uint32_t> followed_;  ///< by node: the last for which all dependencies have been followed
  std::vector<NodeId> begun_list_;
  std::vector<NodeId> passed_list_;
  NodeId node_{};
  std::uint32_t first_ = 0;  ///< nodes before are too far away
};

/// Calls add(place, first, second, is_new) for each pair of names, once; `place` counts first names.
template <class Pairs, class First, class Second, class Add>
void each_pair_once(const TaskNetwork& network, const Pairs& pairs, First first, Second second, Add&& add) {
  std::unordered_map<std::uint32_t, std::size_t> places;  // by first name
  std::unordered_set<std::uint64_t> known;                // pairs of names
  for (const auto& pair : pairs) {
    const std::uint64_t name = network[pair.*first].name;
    if (!known.insert(name << 32U | network[pair.*second].name).second) continue;
    const auto [place, is_new] = places.try_emplace(network[pair.*first].name, places.size());
    add(place->second, network.name_of(pair.*first), network.name_of(pair.*second), is_new);
  }
}

}  // namespace

std::vector<SensesAhead> senses_ahead(const TaskNetwork& network, const Order& order, const Paths& paths) {
  return SensedFinder(network, order, paths).find();
}

std::vector<NamedActsAhead> by_name(const TaskNetwork& network, const std::vector<ActsAhead>& pairs) {
  std::vector<NamedActsAhead> named;
  each_pair_once(network, pairs, &ActsAhead::acts, &ActsAhead::fails,
                 [&](std::size_t place, const std::string& acts, const std::string& fails, bool is_new) {
                   if (is_new) named.push_back({acts, {}});
                   named[place].fails.push_back(fails);
                 });
  return named;
}

std::vector<NamedSensesAhead> by_name(const TaskNetwork& network, const std::vector<SensesAhead>& pairs) {
  std::vector<NamedSensesAhead> named;
  each_pair_once(network, pairs, &SensesAhead::senses, &SensesAhead::acts,
                 [&](std::size_t place, const std::string& senses, const std::string& acts, bool is_new) {
                   if (is_new) named.push_back({senses, {}});
                   named[place].acts.push_back(acts);
                 });
  return named;
}

}  // namespace segue::task_network
