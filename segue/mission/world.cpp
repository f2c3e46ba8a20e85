// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/world.hpp>

#include <algorithm>
#include <ranges>
#include <utility>

namespace segue::mission {

World::World(Facts facts, bool keep, const AttachedData& data, WorldValues values)
    : facts_(std::move(facts)), values_(std::move(values)), keep_(keep) {
  for (const auto& [name, attached] : data)
    data_.emplace(name, attached);
  if (!keep_) return;
  initial_ = facts_;
  initial_data_ = data_;
  initial_values_ = values_;
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

type::Value World::value_of(std::string_view placeholder) const {
  const auto field = placeholder_field(placeholder);
  const auto found = field ? values_.find(field->data) : values_.end();
  return found == values_.end() ? type::Value() : mission::value_of(found->second, placeholder);
}

void World::make(const Change& change) {
  if (const auto* fact = std::get_if<GroundFact>(&change.made)) return set(fact->text, fact->holds);
  const auto& [name, value] = std::get<NewValue>(change.made);
  values_.insert_or_assign(name, value);
}

World::Changes World::apply(std::span<const GroundFact> effects, WorldValues values) {
  const auto first = static_cast<std::uint32_t>(changes_.size());
  const auto make_and_keep = [this](Change change) {
    make(change);
    if (keep_) changes_.push_back(std::move(change));
  };
  for (const GroundFact& effect : effects)
    make_and_keep({effect});
  for (auto& [name, value] : values)
    make_and_keep({NewValue(name, std::move(value))});
  return {first, static_cast<std::uint32_t>(changes_.size())};
}

std::vector<std::string> World::changes() const {
  std::vector<std::string> texts;
  for (const Change& change : changes_) {
    const auto* fact = std::get_if<GroundFact>(&change.made);
    if (fact != nullptr && !change.undone) texts.push_back((fact->holds ? "" : "!") + fact->text);
  }
  return texts;
}

void World::undo(Changes changes) {
  for (std::uint32_t i = changes.first; i < changes.second; ++i)
    changes_[i].undone = true;
  // Data cannot be undone, so all that counts is done again.
  facts_ = initial_;
  data_ = initial_data_;
  values_ = initial_values_;
  for (const Change& change : changes_) {
    if (!change.undone) make(change);
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
