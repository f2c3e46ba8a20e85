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
  for (const Action& action : program.mission().actions) {
    std::vector<std::string>& own = varying_.emplace_back();
    for (const ResourceUse& use : action.resources) {
      std::string pattern = resource_pattern(use.resource);
      if (meets_any(pattern, varying)) own.push_back(std::move(pattern));
    }
  }
}

bool SharedUnits::shared(StateIndex state, std::uint32_t action) {
  if (varying_[action].empty()) return false;
  const auto [known, is_new] = known_.try_emplace({state, action}, false);
  if (is_new) known->second = has_user(state, varying_[action]);
  return known->second;
}

bool SharedUnits::shared_after(StateIndex state, std::uint32_t action) {
  if (varying_[action].empty()) return false;
  const auto [known, is_new] = known_after_.try_emplace({state, action}, false);
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
      known->second = known->second || shared(next, action);
      open.push_back(next);
    }
  }
  return known->second;
}

bool SharedUnits::has_user(StateIndex state, const std::vector<std::string>& resources) const {
  std::vector<StateIndex> open = {state};
  while (!open.empty()) {
    const CompiledState& node = program_.node(open.back());
    open.pop_back();
    open.insert(open.end(), node.children.begin(), node.children.end());
    if (node.kind == StateKind::Library) open.push_back(node.library);
    const auto used = [&](const std::string& own) { return meets_any(own, resources); };
    if (is_leaf(node.kind) && std::ranges::any_of(varying_[node.action], used)) return true;
  }
  return false;
}

}  // namespace segue::mission
