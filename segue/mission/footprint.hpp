// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/mission/mission.hpp>

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace segue::mission {

/// A fact with values in the places of inputs: "at(robot,table)", "ready()".
struct GroundFact {
  std::string text;
  bool holds = true;  ///< or does not
  friend bool operator==(const GroundFact&, const GroundFact&) = default;
};

/// What one execution of an action relies on, and what it changes.
struct Footprint {
  std::vector<GroundFact> preconditions;  ///< each fact once
  std::vector<GroundFact> effects;        ///< likewise; of contradicting ones that which makes the fact true
  std::vector<std::string> resources;     ///< the names, in the order of the action's declaration
};

/// The positions of the inputs that an action's facts and resources name; each once.
std::vector<std::size_t> naming_inputs(const Action& action);

/// What the action touches with these inputs. InvalidArgument, which names the state (`path`), the fact or
/// resource, the input and its value, where a name cannot be formed: of nothing, a list or a map, or of text
/// that is no argument of a fact; or where preconditions contradict each other, or a resource is not as its
/// parameters ask.
Result<Footprint> footprint(const Mission& mission, const Action& action, std::span<const type::Value> inputs,
                            std::string_view path);

/// Why an action whose precondition is not as it says does not begin.
std::string precondition_error(const GroundFact& precondition);

/// A fact without inputs as it is named everywhere: "at(robot,table)", "ready()". InvalidArgument where it is
/// none.
Result<GroundFact> ground(const Fact& fact);

/// "p(a)" or "!p(a)": what holds, or does not, at the beginning of a run. ParseError.
Result<Fact> parse_initial_fact(std::string_view text);

}  // namespace segue::mission
