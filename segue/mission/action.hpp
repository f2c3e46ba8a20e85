// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/action_class.hpp>
#include <segue/base/clock.hpp>
#include <segue/base/error.hpp>
#include <segue/base/id.hpp>
#include <segue/mission/controller_use.hpp>
#include <segue/mission/mission_port.hpp>
#include <segue/mission/observed_units.hpp>
#include <segue/mission/pool_call.hpp>
#include <segue/type/value.hpp>

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

/// Missions: hierarchical state machines with explicit data flow, their actions, their files, and the engine
/// that runs them sequentially.
namespace segue::mission {

using ActionName = Id<struct ActionTag>;

enum class ResourceClass { System, Process, Module, World, Task };
inline constexpr std::array<std::string_view, 5> kResourceClassNames = {"system", "process", "module",
                                                                        "world", "task"};

enum class ResourceOperation { Create, Consume, Delete, Block, Release, Exists };
inline constexpr std::array<std::string_view, 6> kResourceOperationNames = {"create", "consume", "delete",
                                                                            "block",  "release", "exists"};

/// A resource of which `count` units exist before the mission begins; with 0, an action must create it. Its
/// `parameters` describe it and never change.
///
/// Of one that is `of_robot`, the robot on which the mission runs says how many units there are, and keeps
/// what becomes of them (UnitKeeper); `count` is how many there are where it runs without a robot.
struct Resource {
  static constexpr int kNoCount = -1;  ///< of a robot's resource: no number was given
  std::string name;
  ResourceClass kind = ResourceClass::System;
  int count = 1;
  type::Value parameters{type::ValueMap{}};
  bool commutes = false;  ///< the order of its users does not matter
  /// While a robot shows fewer units than there are, nobody gets the others.
  std::optional<ObservedUnits> observe{};
  bool of_robot = false;
  SourcePlace where;
  friend bool operator==(const Resource&, const Resource&) = default;
};

/// An action's use of `count` units of a resource. "{port}" in the name stands for the value of that input.
/// `parameters` must equal those of the resource; "{port}" as a parameter is the value of that input. A block
/// ends with the action; with `keep`, if it ends as expected, only with an action that releases the units.
struct ResourceUse {
  ResourceOperation operation = ResourceOperation::Block;
  std::string resource;
  int count = 1;
  type::Value parameters{type::ValueMap{}};
  bool keep = false;  ///< Block
  SourcePlace where;
  /// Whether units are kept after the action, or released that an earlier one has kept.
  [[nodiscard]] bool moves_kept_units() const { return keep || operation == ResourceOperation::Release; }
  friend bool operator==(const ResourceUse&, const ResourceUse&) = default;
};

/// "p(a, {port})": a precondition ("!p(a)" if negated), or an effect ("+p(a)", "-p(a)").
struct Fact {
  bool positive = true;
  std::string predicate;
  std::vector<std::string> arguments;  ///< constants, or "{port}"
  SourcePlace where;
  friend bool operator==(const Fact&, const Fact&) = default;
};
/// The fact without its sign: "p(a,b)".
std::string to_string(const Fact& fact);

/// An effect on data of the world (DeclaredData): what takes the place of the data, or of a field in them,
/// once the action has ended as expected.
struct DataChange {
  std::string field;  ///< "scene", or "scene.arm.pose", with "{name}" in parts after the first
  type::Value value;  ///< "{name}", at any depth, stands for that input or output
  SourcePlace where;
  friend bool operator==(const DataChange&, const DataChange&) = default;
};

/// A C++ function that the program has registered under this name.
struct Callback {
  std::string name;
  friend bool operator==(const Callback&, const Callback&) = default;
};

/// A Python script with execute(self, inputs, outputs, gvm): a file, relative to that of the mission, or
/// text. All scripts of a mission share one interpreter, but `isolated` ones: such an action has its own.
struct Script {
  std::string file;
  std::string text;
  bool isolated = false;
  /// The place where the text begins; without a line, the script is the whole file.
  SourcePlace where{};
  friend bool operator==(const Script&, const Script&) = default;
};

/// An action for trials. Its n-th execution ends with the n-th of `outcomes`, later ones with the last.
struct Simulated {
  Duration duration{};
  std::vector<std::string> outcomes;  ///< empty: the first declared one; may be "aborted" and "preempted"
  std::vector<PortValue> outputs;
  std::string error;  ///< the error with which it aborts
  friend bool operator==(const Simulated&, const Simulated&) = default;
};

/// For deciders: the outcome of the first rule whose states all ended as it says.
struct DecisionRule {
  std::vector<std::pair<std::string, std::string>> when;  ///< state and outcome; empty: always applies
  std::string outcome;
  friend bool operator==(const DecisionRule&, const DecisionRule&) = default;
};
/// The rules of a decider, in their order.
struct Decision {
  std::vector<DecisionRule> rules;
  friend bool operator==(const Decision&, const Decision&) = default;
};

using Procedure =
    std::variant<std::monostate, Callback, Script, Simulated, Decision, ControllerUse, PoolCall>;

/// How likely an action ends with an outcome, `aborted` among them: between 0 and 1.
struct OutcomeLikelihood {
  std::string outcome;
  double likelihood = 0;
  friend bool operator==(const OutcomeLikelihood&, const OutcomeLikelihood&) = default;
};

/// A leaf of the state machine: its work, and the declarations about it.
struct Action {
  ActionName name;
  std::string description;
  std::vector<Port> inputs;
  std::vector<Port> outputs;
  std::vector<std::string> outcomes{"success"};
  std::vector<Fact> preconditions;
  std::vector<Fact> during;  ///< as `preconditions`; observed ones (ObservedFact) must hold all along
  std::vector<Fact> effects;
  std::vector<DataChange> changes;  ///< effects on data, in the order in which they are made
  std::vector<ResourceUse> resources;
  bool pure = false;         ///< its result can be discarded; otherwise it is potentially irreversible
  bool sensing = false;      ///< observes the real world: never runs on a predicted one
  bool reads_world = false;  ///< looks at facts that it does not declare (ActionCall::world)
  std::vector<std::string> reads_data;  ///< names of data that it looks at there, and nothing else
  bool strict = false;                  ///< it waits until nothing before it can fail any more
  /// Its script uses a robot, and may request these controllers ("{input}" in a name stands for the value of
  /// that input); nothing: it uses none. An action that is a controller names it under `run`.
  std::optional<std::vector<std::string>> controllers;
  std::optional<Duration> expected_duration;
  std::string expected_outcome;                ///< empty: not known
  std::vector<OutcomeLikelihood> likelihoods;  ///< as far as they are known
  Procedure run;
  SourcePlace where;
  /// The outcome with which its effects apply: the expected one if it is declared, or else the first. An
  /// action that aborts or is preempted has no effects, also where that is expected.
  [[nodiscard]] std::string_view foreseen_outcome() const {
    const bool declared = std::ranges::find(outcomes, expected_outcome) != outcomes.end();
    return declared || outcomes.empty() ? std::string_view(expected_outcome) : outcomes.front();
  }
  /// The class by which journal, conversion and drawings treat the action. A decision is pure: it depends
  /// only on how states ended.
  [[nodiscard]] ActionClass action_class() const {
    if (sensing) return ActionClass::Sensing;
    return pure || std::holds_alternative<Decision>(run) ? ActionClass::Pure : ActionClass::Irreversible;
  }
  friend bool operator==(const Action&, const Action&) = default;
};

/// Parses "p(a)", "p(a, {b})" or "p", with an optional sign out of `signs` ("!" or "+-") in front.
std::optional<Fact> parse_fact(std::string_view text, std::string_view signs);

/// Whether a text can be an argument of a fact: one line, not empty, without leading or trailing blanks, and
/// without parentheses, brackets, braces and commas.
bool is_fact_argument(std::string_view text);

/// The inputs that placeholders "{port}" in the text name.
std::vector<std::string> placeholders(std::string_view text);

/// The input that a parameter "{port}" names; nothing if the parameter is a plain value.
std::optional<std::string> parameter_input(const type::Value& parameter);

/// The inputs that texts "{port}" in the value name, at any depth, in their order.
std::vector<std::string> inputs_named_in(const type::Value& value);

/// The value with those of `value_of` in place of the texts "{port}" in it, at any depth.
type::Value filled(const type::Value& value,
                   const std::function<const type::Value&(std::string_view port)>& value_of);

}  // namespace segue::mission
