// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/checks.hpp>
#include <segue/mission/mission_io.hpp>

#include <algorithm>
#include <compare>
#include <tuple>

namespace segue::mission::detail {
namespace {

/// The port at one end of a data flow.
struct End {
  Owner owner = Owner::Child;
  std::uint32_t child = 0;   ///< its position among the children, if it belongs to one
  std::uint32_t number = 0;  ///< of the port
  const Port* port = nullptr;
  /// Orders ends by the owner of the port and its number.
  friend auto operator<=>(const End& a, const End& b) {
    return std::tie(a.owner, a.child, a.number) <=> std::tie(b.owner, b.child, b.number);
  }
  friend bool operator==(const End& a, const End& b) { return (a <=> b) == 0; }
};

/// Checks the data flows of one container.
class FlowCheck {
 public:
  FlowCheck(const MissionIndex& index, StateIndex container, Diagnostics& diagnostics)
      : index_(index),
        mission_(index.mission()),
        state_(mission_.states[container]),
        container_(container),
        diagnostics_(diagnostics) {}

  void run() {
    written_.resize(state_.variables.size(), false);
    for (std::size_t i = 0; i < state_.flows.size(); ++i)
      check(state_.flows[i], index_.flow(container_, i));
    std::ranges::stable_sort(writers_, {}, &Writer::to);
    check_writers();
  }

 private:
  struct Writer {
    const DataFlow* flow = nullptr;
    End from;
    End to;
  };

  void check(const DataFlow& flow, const FlowStates& states) {
    const auto from = end(flow.from, states.from, true, flow);
    const auto to = end(flow.to, states.to, false, flow);
    if (!from || !to) return;
    if (!connects(from->port->type, to->port->type)) {
      diagnostics_.error("type-mismatch",
                         flow_text(flow) + ": " + from->port->type + " does not fit into " + to->port->type,
                         flow.where);
    }
    writers_.push_back({&flow, *from, *to});
    if (to->owner == Owner::Variables) written_[to->number] = true;
  }

  std::string flow_text(const DataFlow& flow) const {
    return "data flow " + to_string(flow.from) + " -> " + to_string(flow.to);
  }

  std::optional<End> end(const FlowPort& ref, StateIndex state, bool source, const DataFlow& flow) {
    switch (ref.owner) {
      case Owner::Inputs:
        if (!source) return misused(ref, flow, "only its outputs and variables can be written from inside");
        return port_of(state_.inputs, ref, flow);
      case Owner::Outputs:
        if (source) return misused(ref, flow, "only its inputs and variables can be read from inside");
        return port_of(state_.outputs, ref, flow);
      case Owner::Variables:
        return port_of(state_.variables, ref, flow);
      case Owner::Child:
        break;
    }
    if (state == kNoState) {
      diagnostics_.error("unknown-state",
                         flow_text(flow) + ": " + detail::state_text(mission_, container_) +
                             " has no state " + quote(ref.state.str()),
                         flow.where);
      return std::nullopt;
    }
    const auto interface = index_.interface(state);
    if (!interface) return std::nullopt;
    auto result = port_of(source ? *interface->outputs : *interface->inputs, ref, flow);
    if (result) result->child = index_.position(state);
    return result;
  }

  std::optional<End> misused(const FlowPort& ref, const DataFlow& flow, const std::string& why) {
    diagnostics_.error("bad-flow",
                       flow_text(flow) + ": " + quote(to_string(ref)) + " is of " +
                           detail::state_text(mission_, container_) + " itself; " + why,
                       flow.where);
    return std::nullopt;
  }

  std::optional<End> port_of(const std::vector<Port>& ports, const FlowPort& ref, const DataFlow& flow) {
    const auto found = position(ports, ref.port);
    if (found) return End{ref.owner, 0, static_cast<std::uint32_t>(*found), &ports[*found]};
    diagnostics_.error(
        "unknown-port",
        flow_text(flow) + ": there is no " + quote(to_string(ref)) + suggestion(ports, ref.port), flow.where);
    return std::nullopt;
  }

  /// Reports inputs that are connected, but only to writers that cannot run before the input is read.
  void check_writers() {
    if (writers_.empty()) return;
    if (state_.kind == StateKind::Hierarchy) {
      next_ = Successors(index_, state_);
      reached_ = reached(index_, container_, next_);
      visited_.resize(next_.size(), 0);
    }
    for (std::size_t begin = 0, end = 0; begin < writers_.size(); begin = end) {
      while (end < writers_.size() && writers_[end].to == writers_[begin].to)
        ++end;
      const DataFlow& first = *writers_[begin].flow;
      if (first.to.owner == Owner::Variables || !writers_[begin].to.port->value.is_null()) continue;
      if (first.to.owner == Owner::Child && is_given(writers_[begin])) continue;
      bool possible = false;
      for (std::size_t i = begin; i < end; ++i)
        possible = possible || can_write(writers_[i]);
      if (possible) continue;
      diagnostics_.error("never-written",
                         quote(to_string(first.to)) +
                             " has no default, and nothing that is connected to it can have been written "
                             "when it is read",
                         first.where);
    }
  }

  /// Whether the child overrides the default of the input.
  [[nodiscard]] bool is_given(const Writer& writer) const {
    const State& child = mission_.states[state_.children[writer.to.child]];
    for (const PortValue& value : child.input_values) {
      if (value.port == writer.to.port->name) return true;
    }
    return false;
  }

  [[nodiscard]] bool can_write(const Writer& writer) {
    const FlowPort& from = writer.flow->from;
    if (from.owner == Owner::Inputs) return true;
    if (from.owner == Owner::Variables)
      return !writer.from.port->value.is_null() || written_[writer.from.number];
    if (writer.flow->to.owner == Owner::Outputs)
      return state_.kind != StateKind::Hierarchy || reached_[writer.from.child];
    if (state_.kind != StateKind::Hierarchy) {
      // Concurrent states do not see each other's outputs; the decider runs after all others.
      const StateIndex reader = state_.children[writer.to.child];
      return mission_.states[reader].kind == StateKind::Decider && writer.from.child != writer.to.child;
    }
    return reached_[writer.from.child] && leads(writer.from.child, writer.to.child);
  }

  /// Whether there is a path of transitions between the states. The search is bounded; beyond the bound a
  /// path is assumed.
  bool leads(std::uint32_t from, std::uint32_t to) {
    ++search_;
    std::vector<std::uint32_t> open = {from};
    while (!open.empty()) {
      const std::uint32_t here = open.back();
      open.pop_back();
      for (const std::uint32_t there : next_[here]) {
        if (there == to || budget_ == 0) return true;
        --budget_;
        if (visited_[there] != search_) open.push_back(there);
        visited_[there] = search_;
      }
    }
    return false;
  }

  const MissionIndex& index_;
  const Mission& mission_;
  const State& state_;
  StateIndex container_;
  Diagnostics& diagnostics_;
  std::vector<Writer> writers_;  ///< sorted by what they write
  std::vector<bool> written_;    ///< by variable
  Successors next_;
  std::vector<bool> reached_;
  std::vector<std::uint32_t> visited_;  ///< the last search that visited each
  std::uint32_t search_ = 0;
  std::size_t budget_ = 10'000'000;
};

void check_ports(const MissionIndex& index, StateIndex i, Diagnostics& diagnostics) {
  const Mission& mission = index.mission();
  const State& state = mission.states[i];
  for (const auto* ports : {&state.inputs, &state.outputs, &state.variables}) {
    for (const Port& port : *ports)
      check_value(port, port.value, state_text(mission, i), port.where, mission, diagnostics);
  }
}

void check_given(const MissionIndex& index, StateIndex i, const std::vector<PortValue>& values,
                 const std::vector<Port>& ports, std::string_view kind, Diagnostics& diagnostics) {
  const Mission& mission = index.mission();
  for (const PortValue& value : values) {
    if (const auto port = position(ports, value.port)) {
      check_value(ports[*port], value.value, state_text(mission, i), value.where, mission, diagnostics);
      continue;
    }
    diagnostics.error("unknown-port",
                      state_text(mission, i) + " has no " + std::string(kind) + " " + quote(value.port) +
                          suggestion(ports, value.port),
                      value.where);
  }
}

}  // namespace

void check_data(const MissionIndex& index, Diagnostics& diagnostics) {
  const Mission& mission = index.mission();
  for (StateIndex i = 0; i < mission.states.size(); ++i) {
    const State& state = mission.states[i];
    if (is_container(state.kind)) {
      check_ports(index, i, diagnostics);
      FlowCheck(index, i, diagnostics).run();
    } else if (const auto interface = index.interface(i)) {
      check_given(index, i, state.input_values, *interface->inputs, "input", diagnostics);
      check_given(index, i, state.output_values, *interface->outputs, "output", diagnostics);
    }
  }
}

}  // namespace segue::mission::detail
