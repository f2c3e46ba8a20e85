// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/footprint.hpp>
#include <segue/mission/mission.hpp>

#include <cstdint>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace segue::mission {

/// The facts that hold while a mission runs; all others do not. Not thread safe.
class World {
 public:
  using Facts = std::set<std::string, std::less<>>;
  /// Changes that were made together: the first and the one past the last.
  using Changes = std::pair<std::uint32_t, std::uint32_t>;

  World() = default;
  /// `keep`: remembers changes, so that they can be undone.
  World(Facts facts, bool keep) : facts_(std::move(facts)), keep_(keep) {
    if (keep_) initial_ = facts_;
  }

  [[nodiscard]] const Facts& facts() const { return facts_; }
  [[nodiscard]] bool holds(std::string_view fact) const { return facts_.contains(fact); }
  /// The first that does not hold as it says; null where all do.
  [[nodiscard]] const GroundFact* first_false(std::span<const GroundFact> facts) const;

  Changes apply(std::span<const GroundFact> effects);
  /// As if those had never come about; later ones count.
  void undo(Changes changes);

 private:
  struct Change {
    GroundFact fact;
    bool undone = false;
  };
  Facts facts_;
  Facts initial_;
  std::vector<Change> changes_;
  bool keep_ = false;
};

/// What holds when a run begins: what the mission says, and over that what is given (`positive` or not).
/// InvalidArgument where one is no fact without inputs.
Result<World::Facts> initial_facts(const Mission& mission, std::span<const Fact> given);

}  // namespace segue::mission
