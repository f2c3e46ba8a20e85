// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/subtree_watch.hpp>

namespace segue::convert {

namespace {

/// The facts that became true, and with "!" those that became false.
std::vector<std::string> differences(const mission::World::Facts& before,
                                     const mission::World::Facts& after) {
  std::vector<std::string> facts;
  for (const std::string& fact : after) {
    if (!before.contains(fact)) facts.push_back(fact);
  }
  for (const std::string& fact : before) {
    if (!after.contains(fact)) facts.push_back("!" + fact);
  }
  return facts;
}

}  // namespace

SubtreeWatch::SubtreeWatch(const mission::MissionPart& part, std::vector<std::string> values)
    : values_(std::move(values)),
      facts_(part.world.facts()),
      units_(part.units),
      iterations_(part.iterations),
      begun_(part.iterations->begin(), part.iterations->end()),
      has_data_(!part.world.data().empty()) {}

SubtreeChanges SubtreeWatch::changes(const mission::Engine& engine) const {
  SubtreeChanges changes{has_data_ ? engine.world().changes() : differences(facts_, engine.world().facts()),
                         engine.units().changes_since(units_),
                         {},
                         {}};
  for (const std::string& name : values_)
    changes.values.append(name, engine.world().values().find(name)->second);
  for (std::size_t i = 0; i < begun_.size(); ++i) {
    if (const std::uint32_t now = (*iterations_)[i]; now != begun_[i])
      changes.begun[static_cast<mission::StateIndex>(i)] = now;
  }
  return changes;
}

}  // namespace segue::convert
