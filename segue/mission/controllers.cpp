// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/controllers.hpp>

#include <segue/base/text.hpp>
#include <segue/mission/pool_actions.hpp>
#include <segue/mission/unit_keeper.hpp>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace segue::mission {

namespace {

using Names = std::set<std::string>;
using Edge = std::pair<std::string, std::string>;  ///< controllers that conflict, in the order of their names

Edge edge_of(const std::string& a, const std::string& b) {
  return a < b ? Edge(a, b) : Edge(b, a);
}

/// One unit that the actions of these controllers hold.
struct Exclusion {
  std::string resource;
  Names controllers;
};

/// The names, with inputs in them, of the controllers that the action may use.
std::vector<std::string> controllers_of(const Action& action) {
  if (const auto* use = std::get_if<ControllerUse>(&action.run)) return {use->controller};
  return action.controllers.value_or(std::vector<std::string>());
}

bool may_use(const Action& action, const std::string& controller) {
  return std::ranges::any_of(controllers_of(action),
                             [&](const std::string& pattern) { return can_mean(pattern, controller); });
}

/// The controllers that actions of the mission may use.
Names used_controllers(const Mission& mission, const std::vector<std::string>& controllers) {
  Names used;
  for (const Action& action : mission.actions) {
    for (const std::string& controller : controllers) {
      if (may_use(action, controller)) used.insert(controller);
    }
  }
  return used;
}

/// Groups in which each conflicts with each other, so that every edge is in one of them.
std::vector<Names> groups_of(const std::set<Edge>& edges) {
  std::vector<Names> groups;
  std::set<Edge> covered;
  Names all;
  for (const Edge& edge : edges)
    all.insert({edge.first, edge.second});
  for (const Edge& edge : edges) {
    if (covered.contains(edge)) continue;
    Names group{edge.first, edge.second};
    for (const std::string& other : all) {
      const auto conflicts = [&](const std::string& one) { return edges.contains(edge_of(one, other)); };
      if (!group.contains(other) && std::ranges::all_of(group, conflicts)) group.insert(other);
    }
    for (const std::string& one : group) {
      for (const std::string& other : group)
        covered.insert(edge_of(one, other));
    }
    groups.push_back(std::move(group));
  }
  return groups;
}

/// A small set of exclusions, as far as it is found easily: those that keep most pairs apart come first,
/// until all pairs are apart.
std::vector<Exclusion> exclusions(const ControllerConflicts& conflicts, const Names& used) {
  std::map<std::string, std::set<Edge>> edges_of;
  for (const auto& pair : conflicts.pairs) {
    if (used.contains(pair.a) && used.contains(pair.b)) edges_of[pair.what].insert(edge_of(pair.a, pair.b));
  }
  std::vector<std::pair<std::string, std::set<Edge>>> ordered(edges_of.begin(), edges_of.end());
  std::ranges::stable_sort(ordered, std::ranges::greater(),
                           [](const auto& one) { return one.second.size(); });
  std::vector<Exclusion> found;
  std::set<Edge> apart;
  for (const auto& [what, edges] : ordered) {
    if (std::ranges::includes(apart, edges)) continue;
    const auto groups = groups_of(edges);
    for (const Names& group : groups) {
      const std::vector<std::string> names(group.begin(), group.end());
      found.push_back({groups.size() == 1 ? what : what + " of " + listed(names), group});
    }
    apart.insert(edges.begin(), edges.end());
  }
  for (const std::string& controller : used)
    found.push_back({"controller " + controller, {controller}});
  return found;
}

void hold(Action& action, std::string resource) {
  ResourceUse use;
  use.resource = std::move(resource);
  use.where = action.where;
  action.resources.push_back(std::move(use));
}

void add_resource(Mission& mission, std::string name) {
  Resource resource;
  resource.name = std::move(name);
  mission.resources.push_back(std::move(resource));
}

}  // namespace

bool ControllerConflicts::conflict(std::string_view a, std::string_view b) const {
  return std::ranges::any_of(
      pairs, [&](const Pair& pair) { return (pair.a == a && pair.b == b) || (pair.a == b && pair.b == a); });
}

bool ControllerConflicts::influence(std::string_view a, std::string_view b) const {
  return std::ranges::any_of(influences, [&](const Pair& pair) { return pair.a == a && pair.b == b; });
}

bool uses_controllers(const Mission& mission) {
  return std::ranges::any_of(mission.actions,
                             [](const Action& action) { return !controllers_of(action).empty(); });
}

bool observes(const Mission& mission) {
  const auto is_observed = [](const Resource& resource) { return resource.observe.has_value(); };
  return !mission.observed.empty() || std::ranges::any_of(mission.resources, is_observed);
}

bool needs_robot(const Mission& mission) {
  const bool has_scripts = std::ranges::any_of(
      mission.actions, [](const Action& action) { return action.controllers.has_value(); });
  return has_scripts || uses_controllers(mission) || uses_pools(mission) || observes(mission) ||
         !robot_units(mission).empty();
}

void claim_controllers(Mission& mission, const ControllerConflicts* conflicts) {
  if (!uses_controllers(mission)) return;
  std::vector<Exclusion> all;
  if (conflicts != nullptr) all = exclusions(*conflicts, used_controllers(mission, conflicts->controllers));
  for (Action& action : mission.actions) {
    if (controllers_of(action).empty()) continue;
    if (conflicts == nullptr) hold(action, std::string(kControllerResource));
    for (const Exclusion& one : all) {
      const auto is_meant = [&](const std::string& name) { return may_use(action, name); };
      if (std::ranges::any_of(one.controllers, is_meant)) hold(action, one.resource);
    }
  }
  if (conflicts == nullptr) add_resource(mission, std::string(kControllerResource));
  for (const Exclusion& one : all)
    add_resource(mission, one.resource);
}

}  // namespace segue::mission
