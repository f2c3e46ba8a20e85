// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/checks.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/rafcon/rafcon_state.hpp>

#include <set>

namespace segue::mission::detail {
namespace {

/// Finds the ports of which a value or a data flow does not have the declared type.
class WrongTypes {
 public:
  explicit WrongTypes(const Mission& mission) : mission_(mission), index_(mission) {}

  std::set<const Port*> find() {
    for (const Action& action : mission_.actions) {
      check_defaults(action.inputs);
      check_defaults(action.outputs);
    }
    for (StateIndex i = 0; i < mission_.states.size(); ++i) {
      const State& state = mission_.states[i];
      for (const auto* ports : {&state.inputs, &state.outputs, &state.variables})
        check_defaults(*ports);
      const auto interface = index_.interface(i);
      if (!interface) continue;
      check_values(state.input_values, *interface->inputs);
      check_values(state.output_values, *interface->outputs);
      for (std::size_t flow = 0; flow < state.flows.size(); ++flow)
        check_flow(state, state.flows[flow], index_.flow(i, flow));
    }
    return std::move(found_);
  }

 private:
  void check(const Port& port, const type::Value& value) {
    const bool global = value.is_string() && value.as_string().starts_with('$');
    if (!global && !accepts(port.type, value)) found_.insert(&port);
  }

  void check_defaults(const std::vector<Port>& ports) {
    for (const Port& port : ports)
      check(port, port.value);
  }

  void check_values(const std::vector<PortValue>& values, const std::vector<Port>& ports) {
    for (const PortValue& value : values) {
      if (const auto port = position(ports, value.port)) check(ports[*port], value.value);
    }
  }

  void check_flow(const State& state, const DataFlow& flow, const FlowStates& states) {
    const Port* from = end(state, flow.from, states.from, true);
    const Port* to = end(state, flow.to, states.to, false);
    if (from != nullptr && to != nullptr && !connects(from->type, to->type)) found_.insert(to);
  }

  const Port* end(const State& state, const FlowPort& named, StateIndex child, bool source) const {
    const std::vector<Port>* ports = nullptr;
    switch (named.owner) {
      case Owner::Inputs:
        ports = &state.inputs;
        break;
      case Owner::Outputs:
        ports = &state.outputs;
        break;
      case Owner::Variables:
        ports = &state.variables;
        break;
      case Owner::Child: {
        const auto interface = child == kNoState ? std::nullopt : index_.interface(child);
        if (interface) ports = source ? interface->outputs : interface->inputs;
        break;
      }
    }
    const auto found = ports == nullptr ? std::nullopt : position(*ports, named.port);
    return found ? &(*ports)[*found] : nullptr;
  }

  const Mission& mission_;
  const MissionIndex index_;
  std::set<const Port*> found_;
};

}  // namespace

void widen_types(Mission& mission, Diagnostics& diagnostics) {
  const std::set<const Port*> wrong = WrongTypes(mission).find();
  const auto widen = [&](std::vector<Port>& ports, const std::string& whose, const SourcePlace& where) {
    for (Port& port : ports) {
      if (!wrong.contains(&port)) continue;
      diagnostics.warning("type-mismatch",
                          quote(port.name) + " of " + quote(whose) + " is of type " + port.type +
                              ", but gets values of other types: it takes any value",
                          where);
      port.type = "any";
    }
  };
  for (Action& action : mission.actions) {
    widen(action.inputs, action.name.str(), action.where);
    widen(action.outputs, action.name.str(), action.where);
  }
  for (State& state : mission.states) {
    for (auto* ports : {&state.inputs, &state.outputs, &state.variables})
      widen(*ports, state.id.str(), state.where);
  }
}

}  // namespace segue::mission::detail
