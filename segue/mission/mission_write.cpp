// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/mission_file_parts.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/type/yaml.hpp>

namespace segue::mission {

using type::Value;
using type::ValueMap;

namespace {

std::string target_text(const Target& target) {
  return target.leaves() ? "return " + target.outcome : target.state.str();
}

Value write_flow(const DataFlow& flow) {
  const std::string from = to_string(flow.from);
  const std::string to = to_string(flow.to);
  constexpr std::string_view kLeadsTo = " -> ";
  // A port may have any name; the short form is only used if it can be read back.
  std::string text = from + std::string(kLeadsTo) + to;
  if (text.find(kLeadsTo) == from.size()) return text;
  return Value::map({{"from", from}, {"to", to}});
}

void write_container(ValueMap& map, const State& state) {
  detail::write_ports(map, "inputs", state.inputs);
  detail::write_ports(map, "outputs", state.outputs);
  detail::write_outcomes(map, state.outcomes);
  detail::write_ports(map, "variables", state.variables);
  detail::write_needs(map, state.preconditions, state.resources);
  if (state.start) map.append("start", target_text(*state.start));
  if (state.flows.empty()) return;
  Value::List flows;
  for (const DataFlow& flow : state.flows)
    flows.push_back(write_flow(flow));
  map.append("flows", std::move(flows));
}

void write_use(ValueMap& map, const State& state) {
  if (state.kind == StateKind::Library) {
    map.append("library", state.library);
  } else if (state.action.str() != state.id.str()) {
    map.append("action", state.action.str());
  }
  detail::write_values(map, "inputs", state.input_values);
  detail::write_values(map, "outputs", state.output_values);
}

void write_transitions(ValueMap& map, const State& state) {
  if (state.transitions.empty()) return;
  ValueMap on;
  for (const StateTransition& transition : state.transitions)
    on.append(transition.outcome, target_text(transition.to));
  map.append("on", std::move(on));
}

/// Recurses as deep as the states are nested, which the reader limits.
void write_state(ValueMap& map, const Mission& mission, StateIndex index) {
  const State& state = mission.states[index];
  const bool container = is_container(state.kind);
  const bool plain = state.kind == StateKind::Execution || state.kind == StateKind::Library ||
                     (state.kind == StateKind::Hierarchy && !state.children.empty());
  if (!state.title.empty()) map.append("title", state.title);
  if (!state.script_id.empty()) map.append("id", state.script_id);
  if (!state.description.empty()) map.append("description", state.description);
  if (state.strict) map.append("strict", true);
  if (state.routine) map.append("routine", true);
  if (!plain) map.append("kind", kStateKindNames[static_cast<std::size_t>(state.kind)]);
  container ? write_container(map, state) : write_use(map, state);
  write_transitions(map, state);
  if (state.notes.is_map() && !state.notes.as_map().empty()) map.append("notes", state.notes);
  if (state.children.empty()) return;
  ValueMap children;
  for (const StateIndex child : state.children) {
    ValueMap entry;
    write_state(entry, mission, child);
    children.append(mission.states[child].id.str(), std::move(entry));
  }
  map.append("states", std::move(children));
}

template <class Items, class Name, class Write>
void write_named(ValueMap& map, std::string_view key, const Items& items, Name name, Write write) {
  if (items.empty()) return;
  ValueMap entries;
  for (const auto& item : items)
    entries.append(name(item), write(item));
  map.append(std::string(key), std::move(entries));
}

}  // namespace

std::string write_mission(const Mission& mission) {
  ValueMap map;
  map.append("mission", mission.name);
  if (mission.at_end == Mission::AtEnd::Keep) map.append("at_end", "keep");
  detail::write_ports(map, "globals", mission.globals);
  detail::write_vocabulary(map, mission.vocabulary);
  if (!mission.world.empty()) {
    Value::List world;
    for (const Fact& fact : mission.world)
      world.emplace_back(to_string(fact));
    map.append("world", std::move(world));
  }
  detail::write_declared_data(map, mission.world_data);
  detail::write_observed(map, mission.observed);
  write_named(
      map, "resources", mission.resources, [](const Resource& resource) { return resource.name; },
      detail::write_resource);
  write_named(
      map, "actions", mission.actions, [](const Action& action) { return action.name.str(); },
      detail::write_action);
  if (!mission.states.empty()) write_state(map, mission, 0);
  write_named(
      map, "libraries", mission.libraries, [](const Library& library) { return library.name; },
      [&](const Library& library) {
        ValueMap entry;
        write_state(entry, mission, library.root);
        return Value(std::move(entry));
      });
  return type::to_yaml(map);
}

}  // namespace segue::mission
