// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/mission_index.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission/state_path.hpp>
#include <segue/mission_engine/engine_core.hpp>

namespace segue::mission::detail {

using type::Value;

Activation* EngineCore::make(StateIndex state, Activation* parent) {
  if (free_.empty()) {
    pool_.emplace_back();
    free_.push_back(&pool_.back());
  }
  Activation& activation = *free_.back();
  free_.pop_back();
  activation.state = state;
  activation.parent = parent;
  activation.shown_as = state;
  activation.phase = Activation::Phase::Begin;
  activation.preempted = activation.held = activation.pass = activation.mark = activation.deferred = false;
  activation.begins_again = activation.refused = activation.replayed = activation.asks = activation.told =
      false;
  activation.around = parent == nullptr ? around_root_ : parent->inside;
  activation.inside = activation.around;
  activation.changed = {};
  activation.item = History::kNone;
  activation.outcome = activation.last = 0;
  activation.pending = {};
  activation.open = 0;
  activation.first = nullptr;
  return &activation;
}

void EngineCore::free(Activation& activation) {
  ++activation.generation;
  activation.error.clear();
  activation.error_before.clear();
  activation.inputs.clear();
  activation.outputs.clear();
  activation.children.clear();
  activation.branches.clear();
  activation.effects.clear();
  activation.observed = nullptr;
  activation.asked.clear();
  activation.units = {};
  activation.unit_wait = {};
  activation.around = activation.inside = nullptr;
  activation.undo.clear();
  free_.push_back(&activation);
}

void EngineCore::free_children(Activation& container) {
  for (Activation* child : container.children)
    free(*child);
  container.children.clear();
}

Value EngineCore::fallback(const PortSource& supply) {
  if (supply.global.empty()) return supply.fallback;
  auto value = globals.get(supply.global);
  if (value) return std::move(*value);
  if (options.warn) options.warn("there is no global variable " + supply.global);
  return {};
}

/// A null value hides no older one of another slot.
const Slot* EngineCore::newest(const PortSource& supply, const Activation& container) {
  const Slot* found = nullptr;
  for (const std::uint32_t index : supply.slots) {
    const Slot& slot = container.slots[index];
    if (!slot.value.is_null() && slot.stamp > (found == nullptr ? 0 : found->stamp)) found = &slot;
  }
  return found;
}

/// A null value never replaces a default.
void EngineCore::fill_inputs(Activation& child, Activation& container) {
  const CompiledState& node = program->node(child.state);
  child.inputs.clear();
  child.inputs.reserve(node.inputs.size());
  for (std::size_t i = 0; i < node.inputs.size(); ++i) {
    const Slot* slot = newest(node.inputs[i], container);
    child.inputs.push_back(slot != nullptr ? slot->value : fallback(node.inputs[i]));
    const Port& port = (*node.input_ports)[i];
    if (!options.warn || accepts(port.type, child.inputs.back())) continue;
    warn(child, "input " + port.name + " is of type " + port.type + ", but gets " +
                    type::describe(child.inputs.back()));
  }
  if (container.last != kAborted || container.error.empty()) return;
  child.error_before = container.error;
  if (const auto port = position(*node.input_ports, "error")) child.inputs[*port] = container.error;
}

/// The inputs of an action that are what it sees of the world.
void EngineCore::fill_world_inputs(Activation& leaf) {
  const std::vector<Port>& ports = *program->node(leaf.state).input_ports;
  for (std::size_t i = 0; i < leaf.inputs.size(); ++i) {
    if (ports[i].from_world) leaf.inputs[i] = world.value_of(ports[i].name);
  }
}

/// The values of the world that the action changes, as they are then.
WorldValues EngineCore::new_values(const Action& action, const Activation& leaf) const {
  static const Value kNull;
  const auto port = [&](std::string_view name) -> const Value& {
    if (const auto input = position(action.inputs, name)) return leaf.inputs[*input];
    const auto output = position(action.outputs, name);
    return output ? leaf.outputs[*output] : kNull;
  };
  WorldValues values;
  for (const std::string& name : values_changed(action)) {
    const auto old = world.values().find(name);
    values.emplace(name,
                   changed_value(action, name, old == world.values().end() ? kNull : old->second, port));
  }
  return values;
}

void EngineCore::set_up(Activation& container) {
  const CompiledState& node = program->node(container.state);
  container.slots.resize(node.slots);
  for (Slot& slot : container.slots)
    slot.stamp = 0;
  // Defaults of variables count as written before everything else.
  auto slot = static_cast<std::uint32_t>(container.inputs.size());
  for (const PortSource& variable : node.variables)
    container.slots[slot++] = {fallback(variable), ++stamp_};
  auto copy = node.at_begin.begin();
  for (std::uint32_t i = 0; i < container.inputs.size(); ++i) {
    container.slots[i] = {container.inputs[i], ++stamp_};
    for (; copy != node.at_begin.end() && copy->from == i; ++copy)
      container.slots[copy->to] = {container.inputs[i], ++stamp_};
  }
}

void EngineCore::set(Activation& container, std::uint32_t slot, Value value) {
  Slot& there = container.slots[slot];
  if (options.backward) replaced_.emplace_back(slot, std::exchange(there, {}));
  there.value = std::move(value);
  there.stamp = ++stamp_;
}

void EngineCore::take_outputs(Activation& container, const Activation& child) {
  const CompiledState& node = program->node(child.state);
  for (std::uint32_t i = 0; i < child.outputs.size(); ++i)
    set(container, node.first_output + i, child.outputs[i]);
  for (const SlotCopy& copy : node.into_variables)
    set(container, copy.to, container.slots[copy.from].value);
}

void EngineCore::give_outputs(Activation& container) {
  const CompiledState& node = program->node(container.state);
  container.outputs.clear();
  for (const PortSource& output : node.outputs) {
    const Slot* slot = newest(output, container);
    const PortSource& shown = program->node(container.shown_as).outputs[container.outputs.size()];
    container.outputs.push_back(slot != nullptr ? slot->value : fallback(shown));
  }
}

void EngineCore::warn(const Activation& activation, const std::string& message) const {
  options.warn(path(activation) + ": " + message);
}

std::string EngineCore::path(const Activation& activation) const {
  std::vector<const std::string*> ids;
  for (const Activation* a = &activation; a != nullptr; a = a->parent) {
    // The root of a library has no path element of its own.
    if (program->node(a->state).parent != kNoState) ids.push_back(&program->state(a->state).id.str());
  }
  return state_path(ids, options.part ? options.part->path : std::string());
}

}  // namespace segue::mission::detail
