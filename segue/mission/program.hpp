// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/mission/mission.hpp>
#include <segue/mission/outcome.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace segue::mission {

struct ControllerConflicts;

/// The next step after an outcome.
struct NextStep {
  enum class Kind : std::uint8_t { Nowhere, Child, Leave };
  Kind kind = Kind::Nowhere;
  std::uint32_t child = 0;  ///< Child: position among the children
  Outcome outcome = 0;      ///< Leave: outcome of the parent
};

/// The source of a port's value. A container has slots for its inputs, its variables, and the outputs of its
/// children, in this order.
struct PortSource {
  std::vector<std::uint32_t> slots;  ///< the most recently written one counts
  type::Value fallback;
  std::string global;  ///< used as the fallback; empty: `fallback` is
};

/// Copies one slot to another.
struct SlotCopy {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
};

/// One state with all names resolved. Members that concern the parent are empty for roots.
struct CompiledState {
  StateKind kind = StateKind::Execution;
  StateIndex parent = kNoState;
  std::uint32_t position = 0;     ///< among the children of the parent
  std::uint32_t action = 0;       ///< leaves: position in Mission::actions
  StateIndex library = kNoState;  ///< Library: the root that it runs
  const std::vector<Port>* input_ports = nullptr;
  const std::vector<Port>* output_ports = nullptr;
  const std::vector<std::string>* outcomes = nullptr;

  std::vector<PortSource> inputs;        ///< evaluated when the state begins
  std::vector<PortSource> outputs;       ///< containers: from their own slots; others: fallbacks only
  std::vector<NextStep> next;            ///< by outcome + 2; see next_after()
  std::uint32_t first_output = 0;        ///< slot of its first output in the parent
  std::vector<SlotCopy> into_variables;  ///< done in the parent when it has ended, by output port

  std::uint32_t slots = 0;  ///< containers, from here on
  std::vector<StateIndex> children;
  NextStep start;
  std::vector<PortSource> variables;         ///< initial values
  std::vector<SlotCopy> at_begin;            ///< from inputs to variables: each after its input is written
  StateIndex decider = kNoState;             ///< Barrier
  std::shared_ptr<const Action> required{};  ///< its preconditions and resources, with its inputs; null: none

  /// The step of the parent after that outcome.
  [[nodiscard]] const NextStep& next_after(Outcome outcome) const {
    return next[static_cast<std::size_t>(std::ptrdiff_t{outcome} + 2)];
  }
  [[nodiscard]] NextStep& next_after(Outcome outcome) {
    return next[static_cast<std::size_t>(std::ptrdiff_t{outcome} + 2)];
  }
};

/// A mission that is ready to run: names are resolved to positions. Immutable; engines may share it.
class Program {
 public:
  /// InvalidArgument with the first problem that validate() finds. `conflicts`: of the robot that the mission
  /// commands; see claim_controllers.
  static Result<std::shared_ptr<const Program>> compile(Mission mission,
                                                        const ControllerConflicts* conflicts = nullptr);

  /// The mission as it was written, except for units that are kept (move_kept_units), units that controllers
  /// need (claim_controllers), and inputs for what actions see of the world (add_world_inputs).
  [[nodiscard]] const Mission& mission() const { return mission_; }
  /// By StateIndex.
  [[nodiscard]] const std::vector<CompiledState>& nodes() const { return nodes_; }
  [[nodiscard]] const CompiledState& node(StateIndex state) const { return nodes_[state]; }
  [[nodiscard]] const State& state(StateIndex state) const { return mission_.states[state]; }
  /// The declarations of a leaf or a container; null if a container declares nothing, and for libraries.
  [[nodiscard]] const Action* declared(StateIndex state) const {
    const CompiledState& node = nodes_[state];
    return is_leaf(node.kind) ? &mission_.actions[node.action] : node.required.get();
  }
  /// Whether a state has something to do when one before it is preempted.
  [[nodiscard]] bool handles_preemption() const;
  [[nodiscard]] std::string outcome_name(StateIndex state, Outcome outcome) const;
  /// The error of a container that aborts because its state ended with an outcome of its own that leads
  /// there.
  [[nodiscard]] std::string abort_text(StateIndex child, Outcome outcome) const;
  /// The error of a container that aborts because its start leads there.
  [[nodiscard]] std::string start_abort_text(StateIndex container) const;
  /// The state at a path such as "fetch/take" and those around it, the outermost first; without roots of
  /// libraries. NotFound, with the names that there are.
  [[nodiscard]] Result<std::vector<StateIndex>> states_on(std::string_view path) const;
  /// The position of the mission's input of that name. NotFound; TypeMismatch where it does not take `value`.
  [[nodiscard]] Result<std::size_t> input_for(std::string_view name, const type::Value& value) const;

  explicit Program(Mission mission) : mission_(std::move(mission)) {}

 private:
  Mission mission_;
  std::vector<CompiledState> nodes_;
};

}  // namespace segue::mission
