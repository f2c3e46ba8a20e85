// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/mission/mission.hpp>

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace segue::mission {

/// A fact with values in place of inputs: "at(robot,table)", "ready()".
struct GroundFact {
  std::string text;
  bool holds = true;  ///< false: it must not hold, or is made false
  friend bool operator==(const GroundFact&, const GroundFact&) = default;
};

/// The facts, resources and data that one execution of an action relies on, and those that it changes.
struct Footprint {
  std::vector<GroundFact> preconditions;  ///< no duplicates; with those of `while`
  std::vector<GroundFact> during;         ///< those of `while`, no duplicates
  std::vector<GroundFact>
      effects;  ///< no duplicates; of contradicting ones, the one that makes the fact true
  std::vector<std::string> resources;  ///< names, in the order in which the action declares them
};

/// The positions of the inputs that an action's facts and resources refer to; no duplicates.
std::vector<std::size_t> naming_inputs(const Action& action);

/// The facts and resources of an execution with these inputs. InvalidArgument if a name cannot be formed,
/// since an input is null, a list, a map, or text that cannot be an argument; if preconditions contradict
/// each other; or if a resource does not have the required parameters. The error names the state (`path`),
/// the fact or resource, the input and its value.
Result<Footprint> footprint(const Mission& mission, const Action& action, std::span<const type::Value> inputs,
                            std::string_view path);

/// The error of an action that does not begin since this precondition is not met.
std::string precondition_error(const GroundFact& precondition);

/// A fact without inputs in its canonical form: "at(robot,table)", "ready()". InvalidArgument if it is
/// malformed or refers to an input.
Result<GroundFact> ground(const Fact& fact);

/// Whether the mission binds that fact, "at(robot,table)", to the robot.
[[nodiscard]] bool is_observed(const Mission& mission, std::string_view fact);

/// Parses "p(a)" or "!p(a)": a fact that holds, or does not, at the beginning of a run. ParseError.
Result<Fact> parse_initial_fact(std::string_view text);

}  // namespace segue::mission
