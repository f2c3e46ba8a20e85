// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/footprint.hpp>
#include <segue/mission/units.hpp>

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace segue::mission {

/// The declarations of the containers around a state, which hold for everything in them. Immutable, so that
/// states share it.
struct EnclosingScope {
  /// Units that a container holds from its begin to its end. The states in it use these units: they are those
  /// of a resource of their own, `lent`.
  struct Held {
    std::string resource;
    std::string lent;   ///< "arm (held by fetch)"
    std::string taken;  ///< from what the container took them: `resource`, or what an outer container lends
    std::uint32_t count = 1;
  };
  std::vector<GroundFact> required;  ///< preconditions of each action
  std::vector<Held> held;            ///< the innermost first
};
/// Null: nothing is declared around the state.
using EnclosingScopePtr = std::shared_ptr<const EnclosingScope>;

/// The facts of an execution that are observed (ObservedFact), with those that are declared around it.
struct ObservedNeeds {
  std::vector<GroundFact> preconditions;  ///< with those of `during`
  std::vector<GroundFact> during;
  std::vector<GroundFact> effects;
};
/// Null: none is.
using ObservedNeedsPtr = std::shared_ptr<const ObservedNeeds>;

/// The facts and units that an execution needs to begin and those that it changes, with the declarations
/// around it. Those of a container are its own only.
struct Needs {
  std::vector<GroundFact> preconditions;
  std::vector<GroundFact> effects;
  std::vector<UnitUse> uses;
  std::vector<std::string> resources;  ///< by use: its resource without regard to what is around
  ObservedNeedsPtr observed;           ///< of its facts
};

/// The needs of an execution with these inputs, and the errors of footprint(). `action` may be the
/// declarations of a container (CompiledState::required). InvalidArgument also if preconditions around
/// contradict its own, or it changes the number of units that a container holds.
Result<Needs> needs(const Mission& mission, const Action& action, std::span<const type::Value> inputs,
                    std::string_view path, const EnclosingScopePtr& around);

/// The scope of the states in a container of this path that has these needs.
EnclosingScopePtr inside(const Needs& container, std::string_view path, const EnclosingScopePtr& around);

}  // namespace segue::mission
