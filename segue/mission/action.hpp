// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/error.hpp>
#include <segue/base/id.hpp>
#include <segue/type/value.hpp>

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

/// Missions: hierarchical state machines with explicit data flow, the actions they consist of, their files,
/// and the engine that runs them as they are written.
namespace segue::mission {

using ActionName = Id<struct ActionTag>;

/// Where something was written. Never takes part in comparison.
struct Place : SourceLocation {
  Place() = default;
  Place(SourceLocation where) : SourceLocation(std::move(where)) {}  // NOLINT(google-explicit-constructor)
  friend bool operator==(const Place&, const Place&) { return true; }
};

/// An input, an output, a scoped variable or a global variable. `type` is any, bool, int, float, text, list
/// or map, or the name of another type, which accepts any value. `value` is what it holds before anybody
/// wrote it; a text "$name" there stands for the global variable `name` when it is read, "$$name" for the
/// text "$name".
struct Port {
  std::string name;
  std::string type = "any";
  type::Value value;
  Place where;
  friend bool operator==(const Port&, const Port&) = default;
};

/// A value that a state gives to a port of the action or library it uses, in place of the declared one.
struct PortValue {
  std::string port;
  type::Value value;
  Place where;
  friend bool operator==(const PortValue&, const PortValue&) = default;
};

enum class ResourceClass { System, Process, Module, World, Task };
inline constexpr std::array<std::string_view, 5> kResourceClassNames = {"system", "process", "module",
                                                                        "world", "task"};

enum class ResourceOperation { Create, Consume, Delete, Block, Release, Exists };
inline constexpr std::array<std::string_view, 6> kResourceOperationNames = {"create", "consume", "delete",
                                                                            "block",  "release", "exists"};

/// A resource that exists before the mission begins, `count` times; with 0 somebody must create it. Its
/// `parameters` tell what it is like; nothing changes them.
struct Resource {
  std::string name;
  ResourceClass kind = ResourceClass::System;
  int count = 1;
  type::Value parameters{type::ValueMap{}};
  bool commutes = false;  ///< the order of its users does not matter
  Place where;
  friend bool operator==(const Resource&, const Resource&) = default;
};

/// What an action does with `count` units of a resource. "{port}" in the name stands for the value of that
/// input. `parameters` are what it asks of the resource's own; one that is "{port}" is the value of that
/// input.
struct ResourceUse {
  ResourceOperation operation = ResourceOperation::Block;
  std::string resource;
  int count = 1;
  type::Value parameters{type::ValueMap{}};
  Place where;
  friend bool operator==(const ResourceUse&, const ResourceUse&) = default;
};

/// "p(a, {port})": what holds ("!p(a)": does not hold), or what becomes so ("+p(a)", "-p(a)").
struct Fact {
  bool positive = true;
  std::string predicate;
  std::vector<std::string> arguments;  ///< constants, or "{port}"
  Place where;
  friend bool operator==(const Fact&, const Fact&) = default;
};
/// Without its sign: "p(a,b)".
std::string to_string(const Fact& fact);

/// A C++ function that the program registers under this name.
struct Callback {
  std::string name;
  friend bool operator==(const Callback&, const Callback&) = default;
};

/// A Python script with execute(self, inputs, outputs, gvm): a file, relative to the mission's, or its text.
struct Script {
  std::string file;
  std::string text;
  friend bool operator==(const Script&, const Script&) = default;
};

/// An action for trials. Its n-th execution gives the n-th of `outcomes`, later ones the last.
struct Simulated {
  Duration duration{};
  std::vector<std::string>
      outcomes;  ///< empty: the first that the action declares; "aborted" and "preempted" too
  std::vector<PortValue> outputs;
  std::string error;  ///< what it says when it aborts
  friend bool operator==(const Simulated&, const Simulated&) = default;
};

/// For deciders: the outcome of the first rule whose states ended as it says.
struct DecisionRule {
  std::vector<std::pair<std::string, std::string>> when;  ///< state and outcome; none: always
  std::string outcome;
  friend bool operator==(const DecisionRule&, const DecisionRule&) = default;
};
struct Decision {
  std::vector<DecisionRule> rules;
  friend bool operator==(const Decision&, const Decision&) = default;
};

using Procedure = std::variant<std::monostate, Callback, Script, Simulated, Decision>;

/// What a leaf of the state machine does, and all that is known about it beforehand.
struct Action {
  ActionName name;
  std::string description;
  std::vector<Port> inputs;
  std::vector<Port> outputs;
  std::vector<std::string> outcomes{"success"};
  std::vector<Fact> preconditions;
  std::vector<Fact> effects;
  std::vector<ResourceUse> resources;
  bool pure = false;     ///< its execution can be thrown away; otherwise potentially irreversible
  bool sensing = false;  ///< reads reality: never runs on a predicted world
  std::optional<Duration> expected_duration;
  std::string expected_outcome;  ///< empty: not known
  Procedure run;
  Place where;
  /// The outcome that its effects belong to: the expected one, else the first.
  [[nodiscard]] std::string_view foreseen_outcome() const {
    if (!expected_outcome.empty() || outcomes.empty()) return expected_outcome;
    return outcomes.front();
  }
  friend bool operator==(const Action&, const Action&) = default;
};

/// "p(a)", "p(a, {b})", "p" with an optional sign out of `signs` ("!" or "+-") in front.
std::optional<Fact> parse_fact(std::string_view text, std::string_view signs);

/// Whether a text can be an argument of a fact: one line, not empty, without blanks at its ends and without
/// brackets, braces and commas.
bool is_fact_argument(std::string_view text);

/// The inputs that "{port}" in the text names.
std::vector<std::string> placeholders(std::string_view text);

/// The input that a parameter names which is "{port}"; nothing where it is a value of its own.
std::optional<std::string> parameter_input(const type::Value& parameter);

}  // namespace segue::mission
