// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/footprint.hpp>
#include <segue/mission/mission.hpp>
#include <segue/mission/world_values.hpp>
#include <segue/mission/world_view.hpp>

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace segue::mission {

/// The facts that hold while a mission runs, all others being false, and the data of the world that are
/// values. Not thread safe.
class World {
 public:
  using Facts = WorldView::Facts;
  /// A range of changes that were made together: first, and one past the last.
  using Changes = std::pair<std::uint32_t, std::uint32_t>;

  World() = default;
  /// `keep`: records changes, so that they can be undone, and listed.
  World(Facts facts, bool keep, const AttachedData& data = {}, WorldValues values = {});

  [[nodiscard]] const Facts& facts() const { return facts_; }
  [[nodiscard]] bool holds(std::string_view fact) const { return facts_.contains(fact); }
  [[nodiscard]] WorldView view() const;
  /// The first of those `facts` that count that is not as it says; null if all are.
  [[nodiscard]] const GroundFact* first_false(std::span<const GroundFact> facts,
                                              const std::function<bool(const GroundFact&)>& counts) const;

  [[nodiscard]] const WorldValues& values() const { return values_; }
  /// The value or its field, as a placeholder names it (placeholder_field()); null where there is none.
  [[nodiscard]] type::Value value_of(std::string_view placeholder) const;

  /// `values` replace those of the same names.
  Changes apply(std::span<const GroundFact> effects, WorldValues values = {});
  /// The changes that were made and not undone, in their order, also where a fact had that value already:
  /// "p(a)", "!q(b)". Those of values are not among them.
  [[nodiscard]] std::vector<std::string> changes() const;
  /// Undoes these changes as if they had never been made; later ones remain.
  void undo(Changes changes);

 private:
  using NewValue = std::pair<std::string, type::Value>;
  struct Change {
    std::variant<GroundFact, NewValue> made;
    bool undone = false;
  };
  void set(const std::string& fact, bool holds);
  void make(const Change& change);

  Facts facts_;
  std::map<std::string, SharedWorldData, std::less<>> data_;
  WorldValues values_;
  Facts initial_;
  WorldValues initial_values_;
  std::map<std::string, SharedWorldData, std::less<>> initial_data_;
  std::vector<Change> changes_;
  bool keep_ = false;
};

/// The facts that hold when a run begins: those of the mission, overridden by `given`. InvalidArgument if one
/// of these is malformed or names an input.
Result<World::Facts> initial_facts(const Mission& mission, std::span<const Fact> given);

}  // namespace segue::mission
