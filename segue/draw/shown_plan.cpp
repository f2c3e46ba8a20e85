// SPDX-License-Identifier: Apache-2.0
#include <segue/draw/shown_plan.hpp>

#include <algorithm>
#include <deque>
#include <utility>

namespace segue::draw {

namespace {

using mission::Program;
using mission::State;
using mission::StateIndex;
using type::Value;
using type::ValueMap;

struct Placed {
  StateIndex state = mission::kNoState;
  std::string path;
  std::string in;  ///< path of the container
};

std::string below(const std::string& path, std::string_view id) {
  return path.empty() ? std::string(id) : path + "/" + std::string(id);
}

/// The state whose content is inside: of a library state, that of its library.
StateIndex content_of(const Program& program, StateIndex state) {
  const auto& node = program.node(state);
  return node.kind == mission::StateKind::Library ? node.library : state;
}

Value transitions_of(const State& state, const Placed& placed) {
  Value::List next;
  for (const mission::StateTransition& transition : state.transitions) {
    ValueMap map;
    map.append("outcome", transition.outcome);
    if (transition.to.leaves()) {
      map.append("returns", transition.to.outcome);
    } else {
      map.append("to", below(placed.in, transition.to.state.str()));
    }
    next.emplace_back(std::move(map));
  }
  return next;
}

/// The data flows between two children, once for each pair of ports.
Value flows_of(const State& container, const std::string& path) {
  Value::List flows;
  for (const mission::DataFlow& flow : container.flows) {
    if (flow.from.owner != mission::Owner::Child || flow.to.owner != mission::Owner::Child) continue;
    flows.push_back(Value::map({{"from", below(path, flow.from.state.str())},
                                {"to", below(path, flow.to.state.str())},
                                {"what", flow.from.port + " -> " + flow.to.port}}));
  }
  return flows;
}

/// The units of the robot that an execution takes when it begins.
Value units_of(const Program& program, mission::StateIndex state) {
  Value::List units;
  const mission::Action* declared = program.declared(state);
  if (declared == nullptr) return units;
  for (const mission::ResourceUse& use : declared->resources) {
    using enum mission::ResourceOperation;
    const auto& all = program.mission().resources;
    const auto resource = std::ranges::find(all, use.resource, &mission::Resource::name);
    if (resource == all.end() || !resource->of_robot) continue;
    if (use.operation == Block || use.operation == Consume || use.operation == Delete)
      units.push_back(Value::map({{"name", use.resource}, {"count", use.count}}));
  }
  return units;
}

Value state_value(const Program& program, const Placed& placed) {
  const State& state = program.state(placed.state);
  const State& content = program.state(content_of(program, placed.state));
  ValueMap map;
  map.append("path", placed.path);
  if (!placed.path.empty()) map.append("in", placed.in);
  map.append("title", state.title.empty() ? state.id.str() : state.title);
  map.append("kind", std::string(mission::kStateKindNames.at(static_cast<std::size_t>(content.kind))));
  if (mission::is_leaf(content.kind)) map.append("action", content.action.str());
  if (state.kind == mission::StateKind::Library) map.append("library", state.library);
  if (content.start && !content.start->leaves())
    map.append("start", below(placed.path, content.start->state.str()));
  map.append("next", transitions_of(state, placed));
  if (mission::is_container(content.kind)) map.append("flows", flows_of(content, placed.path));
  if (Value units = units_of(program, content_of(program, placed.state)); !units.as_list().empty())
    map.append("units", std::move(units));
  return map;
}

/// The first few reasons.
std::string because(const std::vector<Diagram::Cause>& causes) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(causes.size(), 3); ++i)
    text += (i == 0 ? "" : "; ") + to_string(causes[i]);
  return text;
}

Value nodes_of(const Diagram& diagram) {
  Value::List nodes;
  for (const Diagram::Node& node : diagram.nodes) {
    Value::List after;
    for (const Diagram::Dependency& dependency : node.before) {
      if (dependency.implied || dependency.causes.empty()) continue;
      const auto condition =
          std::ranges::find(dependency.causes, Diagram::Kind::Condition, &Diagram::Cause::kind);
      const Diagram::Cause& cause =
          condition == dependency.causes.end() ? dependency.causes.front() : *condition;
      after.push_back(Value::map({{"node", static_cast<std::uint64_t>(dependency.from)},
                                  {"kind", std::string(to_string(cause.kind))},
                                  {"subject", cause.subject},
                                  {"because", because(dependency.causes)},
                                  {"holds_start", dependency.holds_start}}));
    }
    Value::List units;
    for (const Diagram::Units& one : node.units)
      units.push_back(Value::map({{"resource", one.resource}, {"observed", one.observed}}));
    nodes.push_back(Value::map({{"name", node.name},
                                {"in", node.container},
                                {"role", std::string(to_string(node.role))},
                                {"after", std::move(after)},
                                {"units", std::move(units)}}));
  }
  return nodes;
}

}  // namespace

Value shown_plan(const Program& program, const Diagram* concurrent) {
  Value::List states;
  std::deque<Placed> waiting = {{0, "", ""}};
  while (!waiting.empty() && states.size() < kMostShownStates) {
    const Placed placed = std::move(waiting.front());
    waiting.pop_front();
    states.push_back(state_value(program, placed));
    for (const StateIndex child : program.node(content_of(program, placed.state)).children)
      waiting.push_back({child, below(placed.path, program.state(child).id.str()), placed.path});
  }
  return Value::map({{"mission", program.mission().name},
                     {"states", std::move(states)},
                     {"complete", waiting.empty()},
                     {"nodes", concurrent == nullptr ? Value() : nodes_of(*concurrent)}});
}

}  // namespace segue::draw
