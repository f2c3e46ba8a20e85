// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/enclosing_scope.hpp>

#include <algorithm>
#include <iterator>
#include <utility>

namespace segue::mission {

namespace {

Result<void> add_required(std::vector<GroundFact>& preconditions, const EnclosingScopePtr& around,
                          std::string_view path) {
  for (const GroundFact& fact : around->required) {
    const auto own = std::ranges::find(preconditions, fact.text, &GroundFact::text);
    if (own == preconditions.end()) {
      preconditions.push_back(fact);
    } else if (own->holds != fact.holds) {
      return fail(ErrorCode::InvalidArgument, std::string(path) + ": its preconditions " + fact.text +
                                                  " and !" + fact.text + " contradict each other");
    }
  }
  return {};
}

/// The facts among these that the mission observes.
std::vector<GroundFact> observed_of(const Mission& mission, const std::vector<GroundFact>& facts) {
  std::vector<GroundFact> found;
  std::ranges::copy_if(facts, std::back_inserter(found),
                       [&](const GroundFact& fact) { return is_observed(mission, fact.text); });
  return found;
}

ObservedNeedsPtr observed_of(const Mission& mission, const Needs& own,
                             const std::vector<GroundFact>& during) {
  if (mission.observed.empty()) return nullptr;
  ObservedNeeds needs{observed_of(mission, own.preconditions), observed_of(mission, during),
                      observed_of(mission, own.effects)};
  if (needs.preconditions.empty() && needs.effects.empty()) return nullptr;
  return std::make_shared<const ObservedNeeds>(std::move(needs));
}

}  // namespace

Result<Needs> needs(const Mission& mission, const Action& action, std::span<const type::Value> inputs,
                    std::string_view path, const EnclosingScopePtr& around) {
  auto touched = footprint(mission, action, inputs, path);
  if (!touched) return touched.error();
  Needs own;
  own.preconditions = std::move(touched->preconditions);
  own.effects = std::move(touched->effects);
  own.resources = touched->resources;
  own.uses = unit_uses(action, std::move(touched->resources));
  if (around != nullptr) {
    if (auto added = add_required(own.preconditions, around, path); !added) return added.error();
  }
  own.observed = observed_of(mission, own, touched->during);
  if (around == nullptr) return own;
  for (UnitUse& use : own.uses) {
    const auto held = std::ranges::find(around->held, use.resource, &EnclosingScope::Held::resource);
    if (held == around->held.end()) continue;
    if (use.operation != ResourceOperation::Block && use.operation != ResourceOperation::Exists) {
      return fail(ErrorCode::InvalidArgument, std::string(path) +
                                                  ": it cannot create, use up, keep or release units of " +
                                                  quote(use.resource) + ", which a state around it blocks");
    }
    use.resource = held->lent;
  }
  return own;
}

EnclosingScopePtr inside(const Needs& container, std::string_view path, const EnclosingScopePtr& around) {
  auto made = std::make_shared<EnclosingScope>();
  made->required = container.preconditions;
  for (std::size_t i = 0; i < container.uses.size(); ++i) {
    const UnitUse& use = container.uses[i];
    if (use.operation != ResourceOperation::Block) continue;
    const std::string& resource = container.resources[i];
    const auto known = std::ranges::find(made->held, resource, &EnclosingScope::Held::resource);
    if (known != made->held.end())
      known->count += use.count;
    else
      made->held.push_back(
          {resource, resource + " (held by " + std::string(path) + ")", use.resource, use.count});
  }
  if (around != nullptr) made->held.insert(made->held.end(), around->held.begin(), around->held.end());
  return made;
}

}  // namespace segue::mission
