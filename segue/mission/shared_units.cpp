// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/shared_units.hpp>
#include <segue/mission/units.hpp>

#include <algorithm>
#include <set>

namespace segue::mission {

namespace {

bool meet(const std::string& a, const std::string& b) {
  return matches_glob(a, b) || matches_glob(b, a);
}

bool meets_any(const std::string& resource, const std::vector<std::string>& others) {
  return std::ranges::any_of(others, [&](const std::string& other) { return meet(resource, other); });
}

}  // namespace

SharedUnits::SharedUnits(const Program& program) : program_(program) {
  const std::vector<std::string> varying = varying_resources(program.mission());
  const auto used = [&](const std::vector<ResourceUse>& uses) {
    Patterns own;
    for (const ResourceUse& use : uses) {
      std::string pattern = resource_pattern(use.resource);
      if (meets_any(pattern, varying)) own.push_back(std::move(pattern));
    }
    return own;
  };
  for (const Action& action : program.mission().actions)
    by_action_.push_back(used(action.resources));
  first_user_.assign(by_action_.size(), kNoState);
  for (StateIndex i = static_cast<StateIndex>(program.nodes().size()); i-- > 0;) {
    const CompiledState& node = program.node(i);
    if (is_leaf(node.kind)) first_user_[node.action] = i;
    if (node.required == nullptr) continue;
    if (Patterns own = used(node.required->resources); !own.empty()) by_container_[i] = std::move(own);
  }
}

const SharedUnits::Patterns& SharedUnits::used_by(StateIndex state) const {
  static const Patterns none;
  const CompiledState& node = program_.node(state);
  if (is_leaf(node.kind)) return by_action_[node.action];
  const auto found = by_container_.find(state);
  return found == by_container_.end() ? none : found->second;
}

/// One of all states that use the same.
StateIndex SharedUnits::alike(StateIndex user) const {
  const CompiledState& node = program_.node(user);
  return is_leaf(node.kind) ? first_user_[node.action] : user;
}

bool SharedUnits::shared(StateIndex state, StateIndex user) {
  if (used_by(user).empty()) return false;
  const auto [known, is_new] = known_.try_emplace({state, alike(user)}, false);
  if (is_new) known->second = has_user(state, used_by(user));
  return known->second;
}

bool SharedUnits::shared_after(StateIndex state, StateIndex user) {
  if (used_by(user).empty()) return false;
  const auto [known, is_new] = known_after_.try_emplace({state, alike(user)}, false);
  if (!is_new) return known->second;
  std::vector<StateIndex> open = {state};
  std::set<StateIndex> seen;
  while (!open.empty() && !known->second) {
    const CompiledState& node = program_.node(open.back());
    open.pop_back();
    for (const NextStep& step : node.next) {
      if (step.kind != NextStep::Kind::Child) continue;
      const StateIndex next = program_.node(node.parent).children[step.child];
      if (!seen.insert(next).second) continue;
      known->second = known->second || shared(next, user);
      open.push_back(next);
    }
  }
  return known->second;
}

bool SharedUnits::has_user(StateIndex state, const Patterns& resources) const {
  std::vector<StateIndex> open = {state};
  while (!open.empty()) {
    const StateIndex next = open.back();
    const CompiledState& node = program_.node(next);
    open.pop_back();
    open.insert(open.end(), node.children.begin(), node.children.end());
    if (node.kind == StateKind::Library) open.push_back(node.library);
    const auto used = [&](const std::string& own) { return meets_any(own, resources); };
    if (std::ranges::any_of(used_by(next), used)) return true;
  }
  return false;
}

}  // namespace segue::mission
