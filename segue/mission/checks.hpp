// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/mission/mission_index.hpp>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

/// The parts of validate(). Internal; each reports all problems that it finds.
namespace segue::mission::detail {

/// Makes all checks below.
Diagnostics validate(const MissionIndex& index);
/// Actions on their own: values, outcomes and placeholders.
void check_actions(const Mission& mission, Diagnostics& diagnostics);
/// Facts that contradict each other, are listed twice, or can never become as an action needs them.
/// Whether types, objects and predicates refer to each other as they should.
void check_vocabulary(const FactVocabulary& vocabulary, Diagnostics& diagnostics);
void check_facts(const Mission& mission, Diagnostics& diagnostics);
/// Data that follow facts: their names and functions, and whether anything concerns them.
void check_declared_data(const Mission& mission, Diagnostics& diagnostics);
/// Resources that an action needs but that can never exist.
void check_resources(const Mission& mission, Diagnostics& diagnostics);
/// Inputs, outputs and outcomes of actions that are controllers: whether they fit the controllers.
void check_controllers(const Mission& mission, Diagnostics& diagnostics);
/// Inputs and outputs of actions that are calls of a pool: whether they fit the operations.
void check_pools(const Mission& mission, Diagnostics& diagnostics);
/// Inputs that "{input}" names anywhere in the value, which the action does not have.
void check_inputs(const Action& action, const type::Value& value, const SourcePlace& where,
                  Diagnostics& diagnostics);
/// States that begin only when too few units are left for them. Requires a mission without errors.
void check_units(const MissionIndex& index, Diagnostics& diagnostics);
/// Names, transitions, reachability, deciders, recursion of libraries.
void check_control(const MissionIndex& index, Diagnostics& diagnostics);
/// Ports and their types; inputs that are read before they can have been written.
void check_data(const MissionIndex& index, Diagnostics& diagnostics);

/// The siblings that the transitions of every child of a hierarchy lead to, by position among the children.
class Successors {
 public:
  Successors() = default;
  Successors(const MissionIndex& index, const State& hierarchy);
  [[nodiscard]] std::size_t size() const { return first_.empty() ? 0 : first_.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> operator[](std::size_t child) const {
    return {all_.data() + first_[child], all_.data() + first_[child + 1]};
  }

 private:
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> all_;
};
/// The children that can be reached from the start of a hierarchy.
std::vector<bool> reached(const MissionIndex& index, StateIndex hierarchy, const Successors& successors);

void check_value(const Port& declared, const type::Value& value, const std::string& what,
                 const SourcePlace& where, const Mission& mission, Diagnostics& diagnostics);

/// ", did you mean 'x'?" among ports.
std::string suggestion(const std::vector<Port>& ports, const std::string& name);
/// The state as messages name it: "state 'look'", "the mission" or "library 'grasp'".
std::string state_text(const Mission& mission, StateIndex state);

}  // namespace segue::mission::detail
