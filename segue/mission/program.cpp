// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/checks.hpp>
#include <segue/mission/controllers.hpp>
#include <segue/mission/kept_units.hpp>
#include <segue/mission/mission_index.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission/pool_actions.hpp>
#include <segue/mission/program.hpp>
#include <segue/mission/world_values.hpp>

#include <algorithm>

namespace segue::mission {
namespace {

/// Resolves the names of a mission that validate() has found no errors in.
class Compiler {
 public:
  Compiler(const MissionIndex& index, std::vector<CompiledState>& nodes)
      : mission_(index.mission()), index_(index), nodes_(nodes) {}

  void run() {
    nodes_.resize(mission_.states.size());
    for (StateIndex i = 0; i < nodes_.size(); ++i)
      interface(i);
    for (StateIndex i = 0; i < nodes_.size(); ++i) {
      if (is_container(nodes_[i].kind)) container(i);
    }
    for (StateIndex i = 0; i < nodes_.size(); ++i) {
      if (nodes_[i].parent != kNoState) transitions(i);
    }
  }

 private:
  void interface(StateIndex i) {
    const State& state = mission_.states[i];
    CompiledState& node = nodes_[i];
    node.kind = state.kind;
    node.parent = state.parent;
    node.children = state.children;
    const Interface shown = *index_.interface(i);
    node.input_ports = shown.inputs;
    node.output_ports = shown.outputs;
    node.outcomes = shown.outcomes;
    node.inputs = supplies(*shown.inputs, state.input_values);
    node.outputs = supplies(*shown.outputs, state.output_values);
    node.variables = supplies(state.variables, {});
    node.next.resize(shown.outcomes->size() + 2);
    if (auto declared = declared_by(state))
      node.required = std::make_shared<const Action>(std::move(*declared));
    if (state.kind == StateKind::Library) {
      node.library = index_.library(state.library)->root;
    } else if (is_leaf(state.kind)) {
      node.action = static_cast<std::uint32_t>(index_.action_of(i) - mission_.actions.data());
    }
  }

  static std::vector<PortSource> supplies(const std::vector<Port>& ports,
                                          const std::vector<PortValue>& given) {
    std::vector<PortSource> result;
    result.reserve(ports.size());
    for (const Port& port : ports) {
      const auto own = std::ranges::find(given, port.name, &PortValue::port);
      result.push_back(supply(own == given.end() ? port.value : own->value));
    }
    return result;
  }

  static PortSource supply(const type::Value& value) {
    PortSource result;
    if (!value.is_string() || !value.as_string().starts_with('$')) {
      result.fallback = value;
    } else if (value.as_string().starts_with("$$")) {
      result.fallback = value.as_string().substr(1);
    } else {
      result.global = value.as_string().substr(1);
    }
    return result;
  }

  void container(StateIndex i) {
    const State& state = mission_.states[i];
    CompiledState& node = nodes_[i];
    auto slot = static_cast<std::uint32_t>(state.inputs.size() + state.variables.size());
    for (std::uint32_t position = 0; position < state.children.size(); ++position) {
      CompiledState& child = nodes_[state.children[position]];
      child.position = position;
      child.first_output = slot;
      slot += static_cast<std::uint32_t>(child.output_ports->size());
      if (child.kind == StateKind::Decider) node.decider = state.children[position];
    }
    node.slots = slot;
    if (state.start) {
      const Target& start = *state.start;
      node.start = step(i, start, start.leaves() ? kNoState : index_.child(i, start.state));
    }
    for (std::size_t flow = 0; flow < state.flows.size(); ++flow)
      connect(i, state.flows[flow], index_.flow(i, flow));
    std::ranges::stable_sort(node.at_begin, {}, &SlotCopy::from);
    for (const StateIndex child : state.children)
      std::ranges::stable_sort(nodes_[child].into_variables, {}, &SlotCopy::from);
  }

  void connect(StateIndex i, const DataFlow& flow, const FlowStates& states) {
    const State& state = mission_.states[i];
    const std::uint32_t from = slot_of(i, flow.from, states.from);
    switch (flow.to.owner) {
      case Owner::Child: {
        CompiledState& child = nodes_[states.to];
        child.inputs[*position(*child.input_ports, flow.to.port)].slots.push_back(from);
        return;
      }
      case Owner::Outputs:
        nodes_[i].outputs[*position(state.outputs, flow.to.port)].slots.push_back(from);
        return;
      default:
        break;
    }
    const SlotCopy copy{from, slot_of(i, flow.to, states.to)};
    if (flow.from.owner == Owner::Child) {
      nodes_[states.from].into_variables.push_back(copy);
    } else {
      nodes_[i].at_begin.push_back(copy);
    }
  }

  [[nodiscard]] std::uint32_t slot_of(StateIndex i, const FlowPort& ref, StateIndex owner) const {
    const State& state = mission_.states[i];
    if (ref.owner == Owner::Inputs) return static_cast<std::uint32_t>(*position(state.inputs, ref.port));
    if (ref.owner == Owner::Variables)
      return static_cast<std::uint32_t>(state.inputs.size() + *position(state.variables, ref.port));
    const CompiledState& child = nodes_[owner];
    return child.first_output + static_cast<std::uint32_t>(*position(*child.output_ports, ref.port));
  }

  void transitions(StateIndex i) {
    const State& state = mission_.states[i];
    for (std::size_t transition = 0; transition < state.transitions.size(); ++transition) {
      const auto& [name, to, where] = state.transitions[transition];
      const Outcome outcome = number(*nodes_[i].outcomes, name);
      nodes_[i].next_after(outcome) = step(state.parent, to, index_.target(i, transition));
    }
  }

  [[nodiscard]] NextStep step(StateIndex container, const Target& target, StateIndex sibling) const {
    if (target.leaves())
      return {NextStep::Kind::Leave, 0, number(*nodes_[container].outcomes, target.outcome)};
    return {NextStep::Kind::Child, index_.position(sibling), 0};
  }

  static Outcome number(const std::vector<std::string>& outcomes, std::string_view name) {
    if (name == kAbortedName) return kAborted;
    if (name == kPreemptedName) return kPreempted;
    return static_cast<Outcome>(std::ranges::find(outcomes, name) - outcomes.begin());
  }

  const Mission& mission_;
  const MissionIndex& index_;
  std::vector<CompiledState>& nodes_;
};

}  // namespace

Result<std::shared_ptr<const Program>> Program::compile(Mission mission,
                                                        const ControllerConflicts* conflicts) {
  auto program = std::make_shared<Program>(std::move(mission));
  const MissionIndex index(program->mission_);
  const Diagnostics problems = detail::validate(index);
  if (problems.has_errors()) return problems.to_error();
  add_world_inputs(program->mission_);
  Compiler(index, program->nodes_).run();
  claim_controllers(program->mission_, conflicts);
  claim_pools(program->mission_);
  move_kept_units(program->mission_);
  return std::shared_ptr<const Program>(std::move(program));
}

bool Program::handles_preemption() const {
  return std::ranges::any_of(nodes_, [](const CompiledState& node) {
    return !node.next.empty() && node.next_after(kPreempted).kind == NextStep::Kind::Child;
  });
}

std::string Program::outcome_name(StateIndex state, Outcome outcome) const {
  if (outcome == kAborted) return std::string(kAbortedName);
  if (outcome == kPreempted) return std::string(kPreemptedName);
  return (*nodes_[state].outcomes)[static_cast<std::size_t>(outcome)];
}

std::string Program::abort_text(StateIndex child, Outcome outcome) const {
  return "state " + quote(state(child).id.str()) + " ended with " + quote(outcome_name(child, outcome)) +
         ", whose transition aborts";
}

std::string Program::start_abort_text(StateIndex container) const {
  return "state " + quote(state(container).id.str()) + " aborts where it starts";
}

Result<std::vector<StateIndex>> Program::states_on(std::string_view path) const {
  std::vector<StateIndex> states;
  StateIndex around = 0;
  for (std::string_view rest = path; !rest.empty();) {
    while (node(around).kind == StateKind::Library)
      around = node(around).library;
    const std::string_view id = rest.substr(0, rest.find('/'));
    rest.remove_prefix(std::min(rest.size(), id.size() + 1));
    std::vector<std::string> names;
    for (const StateIndex child : node(around).children)
      names.push_back(state(child).id.str());
    const auto found = std::ranges::find(names, id);
    if (found == names.end()) {
      const std::string place = states.empty() ? "the mission" : quote(state(states.back()).id.str());
      return fail(ErrorCode::NotFound,
                  "there is no state " + quote(path) + did_you_mean_or_list(id, names, place + " has"));
    }
    around = node(around).children[static_cast<std::size_t>(found - names.begin())];
    states.push_back(around);
  }
  return states;
}

Result<std::size_t> Program::input_for(std::string_view name, const type::Value& value) const {
  const auto& ports = *nodes_[0].input_ports;
  const auto found = position(ports, name);
  if (!found) {
    return fail(ErrorCode::NotFound,
                "the mission has no input " + quote(name) + detail::suggestion(ports, std::string(name)));
  }
  if (!accepts(ports[*found].type, value)) {
    return fail(ErrorCode::TypeMismatch, "the input " + quote(name) + " is of type " + ports[*found].type +
                                             ", not " + type::describe(value));
  }
  return *found;
}

}  // namespace segue::mission
