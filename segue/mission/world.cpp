// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/world.hpp>

#include <algorithm>
#include <ranges>

namespace segue::mission {

namespace {

void set(World::Facts& facts, const std::string& fact, bool holds) {
  if (holds)
    facts.insert(fact);
  else
    facts.erase(fact);
}

}  // namespace

const GroundFact* World::first_false(std::span<const GroundFact> facts) const {
  const auto found =
      std::ranges::find_if(facts, [&](const GroundFact& fact) { return holds(fact.text) != fact.holds; });
  return found == facts.end() ? nullptr : &*found;
}

World::Changes World::apply(std::span<const GroundFact> effects) {
  const auto first = static_cast<std::uint32_t>(changes_.size());
  for (const GroundFact& effect : effects) {
    set(facts_, effect.text, effect.holds);
    if (keep_) changes_.push_back({effect, false});
  }
  return {first, static_cast<std::uint32_t>(changes_.size())};
}

void World::undo(Changes changes) {
  for (std::uint32_t i = changes.first; i < changes.second; ++i)
    changes_[i].undone = true;
  for (std::uint32_t i = changes.first; i < changes.second; ++i) {
    const std::string& fact = changes_[i].fact.text;
    bool holds = initial_.contains(fact);
    for (const Change& change : changes_) {
      if (!change.undone && change.fact.text == fact) holds = change.fact.holds;
    }
    set(facts_, fact, holds);
  }
}

Result<World::Facts> initial_facts(const Mission& mission, std::span<const Fact> given) {
  World::Facts facts;
  for (const auto& list : {std::span<const Fact>(mission.world), given}) {
    for (const Fact& fact : list) {
      const auto grounded = ground(fact);
      if (!grounded) return grounded.error();
      set(facts, grounded->text, grounded->holds);
    }
  }
  return facts;
}

}  // namespace segue::mission
