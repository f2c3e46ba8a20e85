// SPDX-License-Identifier: Apache-2.0
//
// How the unroller plans what actions see of the values of the world, and how they change them.
#include <segue/convert/conversion_fault.hpp>
#include <segue/convert/unroller.hpp>
#include <segue/mission/mission_index.hpp>
#include <segue/mission/world_values.hpp>

#include <algorithm>
#include <set>
#include <string>
#include <utility>

namespace segue::convert {

using mission::Action;
using mission::StateIndex;
using task_network::NodeId;
using task_network::NodeSpec;

/// The input of an action: what flows to it, or what it sees of the world.
Symbol Unroller::input_of(const StateEntry& entry, const Action& action, std::size_t port) {
  if (!action.inputs[port].from_world) return entry.inputs[port];
  return world_.value(mission::placeholder_field(action.inputs[port].name)->data, entry.when, paths_);
}

/// Actions that act or sense do so in reality, and changes of one value are made in program order: the node
/// waits until those before it have been made.
void Unroller::wait_for_changes(const StateEntry& entry, const Action& action, NodeSpec& spec) {
  if (spec.kind == ActionClass::Pure && action.changes.empty()) return;
  for (const std::string& name : mission::values_touched(action))
    wait_for_changes_of(name, entry, spec);
}

void Unroller::wait_for_changes_of(const std::string& name, const StateEntry& entry, NodeSpec& spec) {
  if (planted(ConversionFault::ForgetsChangesOfValues)) return;
  connect(spec, world_.changed_by(name, entry.when, paths_), "world." + name + " changed");
}

/// Each changed value is computed by a node of its own as soon as all that it consists of is known, which may
/// be before the action happens.
void Unroller::change_world(const StateEntry& entry, const Action& action, NodeId by, const StateEnd& end) {
  const auto foreseen = std::ranges::find(action.outcomes, action.foreseen_outcome());
  const auto outcome = static_cast<mission::Outcome>(foreseen - action.outcomes.begin());
  const auto exit = std::ranges::find(end.exits, outcome, &Exit::outcome);
  if (exit == end.exits.end()) return;
  const BranchEdge when = exit->arrival.when;
  for (const std::string& name : mission::values_changed(action)) {
    PlannedNode planned = begin_structural(Role::Change, when);
    planned.state = entry.state;
    planned.variable = name;
    planned.inputs.push_back(connect(spec_, world_.value(name, entry.when, paths_), kValueOutput));
    for (const std::string& source : mission::sources_of_change(action, name)) {
      const auto input = mission::position(action.inputs, source);
      const auto output = mission::position(action.outputs, source);
      const Symbol symbol = input    ? input_of(entry, action, *input)
                            : output ? end.outputs[*output]
                                     : Symbol();
      planned.inputs.push_back(connect(spec_, symbol, source));
    }
    const NodeId id = append(spec_, std::move(planned), "change of " + name);
    Symbol value;
    value.candidates.push_back({id, plan_.network_.names.intern(kValueOutput), when, {}});
    world_.change(name, when, std::move(value), by, plan_.network_.names.intern(kOutcomeOutput), paths_);
  }
}

/// A subtree sees the values that actions in it see or change, and says at its end how those are that it has
/// changed.
void Unroller::connect_subtree_to_world(const StateEntry& entry, NodeSpec& spec, PlannedNode& planned) {
  auto& touched = touched_[entry.state];
  if (!touched) touched = std::make_shared<TouchedValues>(values_within(plan_.program(), entry.state));
  planned.touched = touched;
  for (const std::string& name : touched->all) {
    planned.inputs.push_back(connect(spec, world_.value(name, entry.when, paths_), "world." + name));
    wait_for_changes_of(name, entry, spec);
  }
}

void Unroller::change_world_by_subtree(const StateEntry& entry, NodeId subtree) {
  for (const std::string& name : touched_.at(entry.state)->changed) {
    Symbol value;
    value.candidates.push_back({subtree, plan_.network_.names.intern("world." + name), entry.when, {}});
    world_.change(name, entry.when, std::move(value), subtree, plan_.network_.names.intern(kOutcomeOutput),
                  paths_);
  }
}

namespace {

void collect(const mission::Program& program, StateIndex state, std::set<std::string>& all,
             std::set<std::string>& changed) {
  const mission::CompiledState& node = program.node(state);
  if (mission::is_leaf(node.kind)) {
    const Action& action = program.mission().actions[node.action];
    for (std::string& name : mission::values_changed(action))
      changed.insert(std::move(name));
    for (std::string& name : mission::values_touched(action))
      all.insert(std::move(name));
  } else if (node.kind == mission::StateKind::Library) {
    collect(program, node.library, all, changed);
  }
  for (const StateIndex child : node.children)
    collect(program, child, all, changed);
}

}  // namespace

TouchedValues values_within(const mission::Program& program, StateIndex state) {
  std::set<std::string> all;
  std::set<std::string> changed;
  collect(program, state, all, changed);
  return {{all.begin(), all.end()}, {changed.begin(), changed.end()}};
}

}  // namespace segue::convert
