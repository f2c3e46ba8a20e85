// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/mission/mission.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace segue::mission {

/// Outcomes as numbers: those that every state has, and from 0 its own in the order of their declaration.
using Outcome = std::int32_t;
inline constexpr Outcome kAborted = -1;
inline constexpr Outcome kPreempted = -2;

/// Where an outcome leads.
struct Step {
  enum class Kind : std::uint8_t { Nowhere, Child, Leave };
  Kind kind = Kind::Nowhere;
  std::uint32_t child = 0;  ///< Child: position among the children
  Outcome outcome = 0;      ///< Leave: of the state around
};

/// Where the value of a port comes from. Slots are those of the container: its inputs, its variables, then
/// the outputs of its children in their order.
struct Supply {
  std::vector<std::uint32_t> slots;  ///< the one written last counts
  type::Value fallback;
  std::string global;  ///< the fallback is this global variable; empty: it is `fallback`
};

/// From slot to slot.
struct Copy {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
};

/// One state, with names resolved. What comes from the container around is empty for roots.
struct Node {
  StateKind kind = StateKind::Execution;
  StateIndex parent = kNoState;
  std::uint32_t position = 0;     ///< among the children of the parent
  std::uint32_t action = 0;       ///< leaves: position in Mission::actions
  StateIndex library = kNoState;  ///< Library: the root it runs
  const std::vector<Port>* input_ports = nullptr;
  const std::vector<Port>* output_ports = nullptr;
  const std::vector<std::string>* outcomes = nullptr;

  std::vector<Supply> inputs;        ///< what each input gets when it begins
  std::vector<Supply> outputs;       ///< containers: from their own slots; others: only fallbacks
  std::vector<Step> next;            ///< by outcome + 2
  std::uint32_t first_output = 0;    ///< slot of its first output in the container
  std::vector<Copy> into_variables;  ///< done in the container when it has ended

  std::uint32_t slots = 0;  ///< containers, from here on
  std::vector<StateIndex> children;
  Step start;
  std::vector<Supply> variables;  ///< what each variable is at the beginning
  std::vector<Copy> at_begin;     ///< from inputs into variables
  StateIndex decider = kNoState;  ///< Barrier
};

/// A mission made ready to run: every name is a position. Immutable; any number of engines may share it.
class Program {
 public:
  /// InvalidArgument with the first of the problems that validate() finds.
  static Result<std::shared_ptr<const Program>> compile(Mission mission);

  [[nodiscard]] const Mission& mission() const { return mission_; }
  /// By StateIndex.
  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }
  [[nodiscard]] const Node& node(StateIndex state) const { return nodes_[state]; }
  [[nodiscard]] const State& state(StateIndex state) const { return mission_.states[state]; }
  [[nodiscard]] std::string outcome_name(StateIndex state, Outcome outcome) const;
  /// The position of the mission's input of that name. NotFound; TypeMismatch where it does not take `value`.
  [[nodiscard]] Result<std::size_t> input_for(std::string_view name, const type::Value& value) const;

  explicit Program(Mission mission) : mission_(std::move(mission)) {}

 private:
  Mission mission_;
  std::vector<Node> nodes_;
};

}  // namespace segue::mission
