// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/world.hpp>

#include <algorithm>
#include <ranges>
#include <utility>

namespace segue::mission {

World::World(Facts facts, bool keep, const AttachedData& data) : facts_(std::move(facts)), keep_(keep) {
  for (const auto& [name, attached] : data)
    data_.emplace(name, attached);
  if (!keep_) return;
  initial_ = facts_;
  initial_data_ = data_;
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

std::vector<std::string> World::changes() const {
  std::vector<std::string> texts;
  for (const Change& change : changes_) {
    if (!change.undone) texts.push_back((change.fact.holds ? "" : "!") + change.fact.text);
  }
  return texts;
}

void World::undo(Changes changes) {
  for (std::uint32_t i = changes.first; i < changes.second; ++i)
    changes_[i].undone = true;
  // Data cannot be undone, so all that counts is done again.
  facts_ = initial_;
  data_ = initial_data_;
  for (const Change& change : changes_) {
    if (!change.undone) set(change.fact.text, change.fact.holds);
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
