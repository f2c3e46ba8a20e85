// SPDX-License-Identifier: Apache-2.0
#include "goal_order.hpp"

#include <algorithm>

namespace segue::task_network {

GoalOrder::GoalOrder(const TaskNetwork& network, Order& order, std::vector<Dependency>* further)
    : network_(network), builder_(network, order, further) {
  for (std::uint32_t i = 0; i < network.size(); ++i)
    opaque_ = opaque_ || network[NodeId{i}].opaque;
  collect_facts();
}

void GoalOrder::collect_facts() {
  fact_begin_.assign(network_.facts.size() + 1, 0);
  for (std::uint32_t i = 0; i < network_.access_count(); ++i)
    ++fact_begin_[index(network_.access(i).fact) + 1];
  for (std::size_t i = 1; i < fact_begin_.size(); ++i)
    fact_begin_[i] += fact_begin_[i - 1];
  by_fact_.resize(network_.access_count());
  std::vector<std::uint32_t> next(fact_begin_.begin(), fact_begin_.end());
  for (std::uint32_t i = 0; i < network_.access_count(); ++i)
    by_fact_[next[index(network_.access(i).fact)]++] = i;
}

/// Whether every value of the fact is known in advance, so that its causal links are known too.
bool GoalOrder::foreseeable(FactId fact) const {
  for (std::uint32_t i = fact_begin_[index(fact)]; i < fact_begin_[index(fact) + 1]; ++i) {
    const Access& access = network_.access(by_fact_[i]);
    const NodeRecord& node = network_[access.node];
    if (access.writes &&
        (node.uncertain || opaque_ || node.branches || !network_.conditions(access.node).empty()))
      return false;
  }
  return true;
}

void GoalOrder::link(NodeId from, NodeId to, FactId fact) {
  if (from != to) links_.push_back({from, to, fact});
}

/// Adds the causal links and threats of the literal. `readers_` are the readers in the last interval that is
/// needed; `clobberers_` end that interval and come before the next producer that is needed.
void GoalOrder::add_links(const Literal& literal) {
  Interval now;
  now.has_producer = network_.initial_world.holds(literal);
  readers_.clear();
  clobberers_.clear();
  for (std::uint32_t i = fact_begin_[index(literal.fact)]; i < fact_begin_[index(literal.fact) + 1]; ++i) {
    const Access& access = network_.access(by_fact_[i]);
    if (access.reads && access.needed == literal.value && now.has_producer) {
      need(now, literal.fact);
      if (index(now.producer) != kNone) link(now.producer, access.node, literal.fact);
      if (access.writes || network_[access.node].kind != ActionClass::Pure) readers_.push_back(access.node);
    }
    if (!access.writes) continue;
    if (access.value != literal.value) {
      for (const NodeId reader : readers_)
        link(reader, access.node, literal.fact);
      clobberers_.push_back(access.node);
      now = {};
    } else if (!now.has_producer) {
      now = {true, false, access.node};
    }
  }
  if (now.has_producer && std::ranges::find(goal_, literal) != goal_.end()) need(now, literal.fact);
}

void GoalOrder::need(Interval& interval, FactId fact) {
  if (interval.needed) return;
  interval.needed = true;
  if (index(interval.producer) != kNone) {
    for (const NodeId clobberer : clobberers_)
      link(clobberer, interval.producer, fact);
  }
  // A literal that holds initially and is needed at the end has no clobberers, so nothing is left to order.
  readers_.clear();
  clobberers_.clear();
  if (index(interval.producer) != kNone) readers_.push_back(interval.producer);
}

/// The goal of the network or, without one, the final value of every fact.
std::vector<Literal> GoalOrder::wanted() const {
  if (!network_.goal.empty()) return network_.goal;
  VersionedWorld world = network_.initial_world;
  for (std::uint32_t i = 0; i < network_.access_count(); ++i) {
    const Access& access = network_.access(i);
    if (access.writes) world.set({access.fact, access.value});
  }
  std::vector<Literal> all;
  for (std::uint32_t i = 0; i < network_.facts.size(); ++i)
    all.push_back({FactId{i}, world.holds(FactId{i})});
  return all;
}

void GoalOrder::derive() {
  const auto by_fact = [](const Literal& a, const Literal& b) { return a.fact < b.fact; };
  const std::vector<Literal> goal = [&] {
    auto all = wanted();
    std::ranges::sort(all, by_fact);
    return all;
  }();
  std::vector<bool> foreseen(network_.facts.size());
  for (std::uint32_t i = 0; i < network_.facts.size(); ++i) {
    foreseen[i] = foreseeable(FactId{i});
    if (!foreseen[i]) continue;
    const auto [first, last] = std::equal_range(goal.begin(), goal.end(), Literal{FactId{i}, true}, by_fact);
    goal_.assign(first, last);
    add_links({FactId{i}, true});
    add_links({FactId{i}, false});
  }
  std::ranges::stable_sort(links_, {}, &Link::to);
  builder_.prepare();
  auto link = links_.begin();
  for (std::uint32_t i = 0; i < network_.size(); ++i) {
    const NodeId node{i};
    builder_.begin_node(node);
    for (const Access& access : network_.accesses(node)) {
      if (!foreseen[index(access.fact)]) builder_.add_access(node, access);
    }
    for (; link != links_.end() && link->to == node; ++link)
      builder_.add(link->from, Reason::Fact, index(link->fact));
    builder_.add_resources(node, false);
    builder_.end_node();
  }
  builder_.end();
}

Order derive_order(const TaskNetwork& network, OrderRule rule, std::vector<Dependency>* further) {
  Order order;
  order.reserve(network.size(), std::size_t{network.access_count()} * 2);
  if (rule == OrderRule::Goal)
    GoalOrder(network, order, further).derive();
  else
    OrderBuilder(network, order, further).extend();
  return order;
}

}  // namespace segue::task_network
