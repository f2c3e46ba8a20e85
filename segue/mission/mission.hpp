// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/action.hpp>
#include <segue/mission/declared_data.hpp>
#include <segue/mission/fact_vocabulary.hpp>
#include <segue/mission/state_index.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::mission {

using StateId = Id<struct StateTag>;  ///< unique among the children of a state

enum class StateKind : std::uint8_t { Execution, Hierarchy, Barrier, Preemptive, Library, Decider };
inline constexpr std::array<std::string_view, 6> kStateKindNames = {"execution",  "hierarchy", "barrier",
                                                                    "preemptive", "library",   "decider"};
inline bool is_container(StateKind kind) {
  return kind == StateKind::Hierarchy || kind == StateKind::Barrier || kind == StateKind::Preemptive;
}
/// A state with an action.
inline bool is_leaf(StateKind kind) {
  return kind == StateKind::Execution || kind == StateKind::Decider;
}
inline bool is_concurrency(StateKind kind) {
  return kind == StateKind::Barrier || kind == StateKind::Preemptive;
}

/// The outcomes that every state has in addition to its own.
inline constexpr std::string_view kAbortedName = "aborted";
inline constexpr std::string_view kPreemptedName = "preempted";

/// The target of a transition: a sibling, or an outcome of the parent with which the parent ends.
struct Target {
  StateId state;  ///< empty: the parent ends
  std::string outcome;
  [[nodiscard]] bool leaves() const { return state.empty(); }
  friend bool operator==(const Target&, const Target&) = default;
};

/// Which state follows an outcome.
struct StateTransition {
  std::string outcome;
  Target to;
  SourcePlace where;
  friend bool operator==(const StateTransition&, const StateTransition&) = default;
};

/// The owner of the ports that a data flow connects: a child, or the container itself with its three kinds of
/// ports.
enum class Owner : std::uint8_t { Child, Inputs, Outputs, Variables };
/// One end of a data flow.
struct FlowPort {
  Owner owner = Owner::Child;
  StateId state;  ///< the child
  std::string port;
  friend bool operator==(const FlowPort&, const FlowPort&) = default;
};
std::string to_string(const FlowPort& ref);  ///< "grasp.pose", "variables.count"

/// Data is transferred when the receiver begins, into variables when the writer ends. It never triggers
/// anything.
struct DataFlow {
  FlowPort from;
  FlowPort to;
  SourcePlace where;
  friend bool operator==(const DataFlow&, const DataFlow&) = default;
};

/// One state. Which members are used depends on the kind.
struct State {
  StateId id;
  std::string title;      ///< display name; may be empty
  std::string script_id;  ///< its id in scripts, such as RAFCON's; empty: `id`
  std::string description;
  StateKind kind = StateKind::Execution;
  StateIndex parent = kNoState;
  bool strict = false;   ///< as Action::strict, for every action in it; of the root: of the mission
  bool routine = false;  ///< a concurrent run executes it sequentially, as one node; no leaf
  std::vector<StateTransition> transitions;  ///< of its own outcomes

  ActionName action;                     ///< Execution, Decider
  std::string library;                   ///< Library: "folder/name"
  std::vector<PortValue> input_values;   ///< of the action or library
  std::vector<PortValue> output_values;  ///< of the action or library

  std::vector<Port> inputs;  ///< containers, from here on
  std::vector<Port> outputs;
  std::vector<std::string> outcomes;
  std::vector<Port> variables;
  std::vector<StateIndex> children;  ///< in their order; program order for concurrency
  std::optional<Target> start;       ///< Hierarchy
  std::vector<DataFlow> flows;
  std::vector<Fact> preconditions;     ///< of every action in it
  std::vector<ResourceUse> resources;  ///< Block: from its begin to its end; Exists: when it begins

  type::Value notes{type::ValueMap{}};  ///< data of tools, such as RAFCON's semantic data
  SourcePlace where;
  friend bool operator==(const State&, const State&) = default;
};

/// The declarations of a container for everything in it, as an action with its inputs; nothing if it declares
/// nothing.
std::optional<Action> declared_by(const State& container);

/// A state machine that library states use; `root` is the root of its tree.
struct Library {
  std::string name;
  StateIndex root = kNoState;
  SourcePlace where;
  friend bool operator==(const Library&, const Library&) = default;
};

/// A fact that changes by itself: it holds while the condition `when` on the robot does. States that rely on
/// it are checked against the robot, and so are effects on it, which must show within `settle`. While it
/// cannot be observed, since its task does not run, it keeps the value that was observed last, and effects
/// change it like other facts.
struct ObservedFact {
  static constexpr Duration kSettle = std::chrono::seconds(1);
  Fact fact;  ///< without inputs
  RobotCondition when;
  Duration settle = kSettle;
  SourcePlace where;
  friend bool operator==(const ObservedFact&, const ObservedFact&) = default;
};

/// A mission as it is written. All states are in one list, parents before their children, so that any depth
/// of nesting can be handled without recursion. References are names, which validate() checks. Not thread
/// safe.
struct Mission {
  std::string name;
  std::vector<Port> globals;
  FactVocabulary vocabulary;
  std::vector<Fact> world;               ///< the facts that hold at the beginning, without inputs
  std::vector<DeclaredData> world_data;  ///< that follow the facts
  std::vector<ObservedFact> observed;
  std::vector<Resource> resources;
  std::vector<Action> actions;
  std::vector<State> states;  ///< states[0] is the root
  std::vector<Library> libraries;
  /// Keep: the robot runs on what it runs, however the mission ends; otherwise it comes to rest unless the
  /// mission ends as it should (model::Halt).
  enum class AtEnd : std::uint8_t { Halt, Keep };
  AtEnd at_end = AtEnd::Halt;
  std::string file;
  friend bool operator==(const Mission& a, const Mission& b) {
    return a.name == b.name && a.globals == b.globals && a.vocabulary == b.vocabulary && a.world == b.world &&
           a.world_data == b.world_data && a.observed == b.observed && a.resources == b.resources &&
           a.actions == b.actions && a.states == b.states && a.libraries == b.libraries &&
           a.at_end == b.at_end;
  }

  [[nodiscard]] const State& root() const { return states.front(); }
  /// Appends a state under `parent` (kNoState: a root).
  StateIndex add(StateIndex parent, State state);
  /// The id of the state in scripts.
  [[nodiscard]] const std::string& script_id(StateIndex state) const {
    return states[state].script_id.empty() ? states[state].id.str() : states[state].script_id;
  }
  /// "fetch/grasp": the ids from below the root; "" for a root.
  [[nodiscard]] std::string path(StateIndex state) const;
};

/// Whether running it runs Python: of actions, or of data that follow facts.
[[nodiscard]] bool has_scripts(const Mission& mission);

}  // namespace segue::mission
