// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/world.hpp>

#include <algorithm>
#include <ranges>
#include <utility>

namespace segue::mission {

World::World(Facts facts, bool keep, const AttachedData& data) : facts_(std::move(facts)), keep_(keep) {
  if (keep_) initial_ = facts_;
  for (const auto& [name, attached] : data)
    data_.emplace(name, attached);
}

void World::set(const std::string& fact, bool holds) {
  const bool changed = holds ? facts_.insert(fact).second : facts_.erase(fact) > 0;
  if (!changed) return;
  for (auto& [name, attached] : data_)
    attached.changed(fact, holds);
}

WorldView World::view() const {
  AttachedData data;
  for (const auto& [name, attached] : data_)
    data.emplace(name, attached.share());
  return {facts_, std::move(data)};
}

const GroundFact* World::first_false(std::span<const GroundFact> facts,
                                     const std::function<bool(const GroundFact&)>& counts) const {
  const auto found = std::ranges::find_if(
      facts, [&](const GroundFact& fact) { return holds(fact.text) != fact.holds && counts(fact); });
  return found == facts.end() ? nullptr : &*found;
}

World::Changes World::apply(std::span<const GroundFact> effects) {
  const auto first = static_cast<std::uint32_t>(changes_.size());
  for (const GroundFact& effect : effects) {
    set(effect.text, effect.holds);
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
    set(fact, holds);
  }
}

Result<World::Facts> initial_facts(const Mission& mission, std::span<const Fact> given) {
  World::Facts facts;
  for (const auto& list : {std::span<const Fact>(mission.world), given}) {
    for (const Fact& fact : list) {
      const auto grounded = ground(fact);
      if (!grounded) return grounded.error();
      if (grounded->holds)
        facts.insert(grounded->text);
      else
        facts.erase(grounded->text);
    }
  }
  return facts;
}

}  // namespace segue::mission
