// SPDX-License-Identifier: Apache-2.0
#include "planned_nodes.hpp"

#include <algorithm>
#include <utility>

namespace segue::cli {

using draw::Diagram;

namespace {

/// More blockers of one node do not help a reader.
constexpr std::size_t kMostBlockers = 3;

void add(std::vector<std::uint32_t>& blockers, std::uint32_t node) {
  if (blockers.size() < kMostBlockers && std::ranges::find(blockers, node) == blockers.end())
    blockers.push_back(node);
}

}  // namespace

PlannedNodes::PlannedNodes(Diagram plan)
    : plan_(std::move(plan)), states_(plan_.nodes.size()), outcomes_(plan_.nodes.size()) {
  for (std::uint32_t i = 0; i < plan_.nodes.size(); ++i)
    by_name_.emplace(plan_.nodes[i].name, i);
}

bool PlannedNodes::is_action(Diagram::Role role) {
  return role != Diagram::Role::Join && role != Diagram::Role::Copy && role != Diagram::Role::Global;
}

void PlannedNodes::began(const std::string& name) {
  const auto found = by_name_.find(name);
  if (found != by_name_.end()) states_[found->second] = State::Running;
}

void PlannedNodes::ended(const std::string& name, const std::string& outcome) {
  const auto found = by_name_.find(name);
  if (found == by_name_.end()) return;
  states_[found->second] = State::Ended;
  outcomes_[found->second] = outcome;
}

/// `any_way`: of a join, which is reached by any of several ways.
void PlannedNodes::consider(const Diagram::Dependency& dependency, std::vector<View>& views, View& own,
                            bool any_way) const {
  const std::uint32_t from = dependency.from;
  const auto is_condition = [](const Diagram::Cause& cause) {
    return cause.kind == Diagram::Kind::Condition;
  };
  const auto condition = std::ranges::find_if(dependency.causes, is_condition);
  const bool conditional = condition != dependency.causes.end();
  if (views[from].off) {
    own.off = own.off || (conditional && !any_way);
    return;
  }
  if (!is_action(plan_.nodes[from].role)) {
    for (const std::uint32_t blocker : views[from].blockers)
      add(own.blockers, blocker);
  } else if (states_[from] != State::Ended) {
    if (dependency.holds_start) add(own.blockers, from);
  } else if (conditional && !any_way && outcomes_[from] != condition->subject) {
    own.off = true;
  }
}

std::vector<PlannedNodes::View> PlannedNodes::views() const {
  std::vector<View> views(plan_.nodes.size());
  for (std::size_t i = 0; i < plan_.nodes.size(); ++i) {
    const Diagram::Node& node = plan_.nodes[i];
    for (const Diagram::Dependency& dependency : node.before)
      consider(dependency, views, views[i], node.role == Diagram::Role::Join);
  }
  return views;
}

std::vector<PlannedNodes::Waiting> PlannedNodes::waiting(std::size_t most) const {
  std::vector<Waiting> list;
  const auto all = views();
  for (std::size_t i = 0; i < all.size() && list.size() < most; ++i) {
    const bool waits = states_[i] == State::Planned && is_action(plan_.nodes[i].role) && !all[i].off;
    if (!waits || all[i].blockers.empty()) continue;
    Waiting entry{plan_.nodes[i].name, {}};
    for (const std::uint32_t blocker : all[i].blockers)
      entry.waits_for.push_back(plan_.nodes[blocker].name);
    list.push_back(std::move(entry));
  }
  return list;
}

std::vector<std::string> PlannedNodes::off_path() const {
  std::vector<std::string> names;
  const auto all = views();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].off) names.push_back(plan_.nodes[i].name);
  }
  return names;
}

}  // namespace segue::cli
