// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/conversion_fault.hpp>
#include <segue/convert/unroller.hpp>

#include <algorithm>
#include <string>
#include <utility>

namespace segue::convert {

using mission::StateIndex;
using task_network::NodeId;
using task_network::NodeSpec;
using task_network::OutcomeId;
using type::Value;

namespace {

std::string numbered(std::string_view name, std::size_t number) {
  return number == 0 ? std::string(name) : std::string(name) + '~' + std::to_string(number);
}

/// The value or, where it is null, the first of the defaults that is not; nothing where one of them comes
/// from a node that has not ended.
std::optional<Value> with_defaults(Value value, const Defaults& defaults,
                                   const std::vector<std::shared_ptr<const Value>>& outputs) {
  if (!value.is_null() || !defaults) return value;
  for (const Default& one : *defaults) {
    value = one.value;
    if (index(one.reader) != task_network::kNone) {
      if (index(one.reader) >= outputs.size() || !outputs[index(one.reader)]) return std::nullopt;
      const Value* read = outputs[index(one.reader)]->find(kValueOutput);
      value = read == nullptr ? Value() : *read;
    }
    if (!value.is_null()) break;
  }
  return value;
}

}  // namespace

/// Every candidate becomes a separate input, since their defaults may differ.
ValueSource Unroller::connect(NodeSpec& spec, const Symbol& symbol, std::string_view name) {
  auto& names = plan_.network_.names;
  ValueSource source;
  source.rest = symbol.rest;
  source.rest_turn = symbol.rest_turn;
  for (std::size_t i = symbol.candidates.size(); i-- > 0;) {
    const Candidate& candidate = symbol.candidates[i];
    const std::size_t number = source.feeds.size();
    const auto input = number == 0 ? names.intern(name) : names.intern(numbered(name, number));
    spec.inputs.push_back({candidate.node, candidate.output, input});
    source.feeds.push_back({input, candidate.defaults, candidate.turn});
  }
  const auto readers_of = [&](const Defaults& defaults) {
    if (!defaults) return;
    for (const Default& one : *defaults) {
      if (index(one.reader) == task_network::kNone) continue;
      const auto input = plan_.network_.names.intern("#" + std::to_string(index(one.reader)));
      spec.inputs.push_back({one.reader, plan_.network_.names.intern(kValueOutput), input});
    }
  };
  readers_of(symbol.rest);
  for (const Candidate& candidate : symbol.candidates)
    readers_of(candidate.defaults);
  return source;
}

/// A default of the mission. A global variable is read by a separate node, at its place in the program order.
Default Unroller::fallback(const mission::PortSource& supply, BranchEdge at) {
  if (supply.global.empty()) return {supply.fallback};
  PlannedNode planned = begin_structural(Role::Global, at);
  spec_.kind = ActionClass::Irreversible;
  spec_.opaque = true;
  planned.variable = supply.global;
  return {Value(), append(spec_, std::move(planned), "$" + supply.global)};
}

std::vector<Symbol> Unroller::inputs_of(ContainerExecution& activation, StateIndex child, BranchEdge at) {
  std::vector<Symbol> inputs;
  for (const mission::PortSource& supply : node(child).inputs) {
    Symbol input = read(activation, supply.slots, at);
    const Default none = fallback(supply, at);
    for (Candidate& candidate : input.candidates)
      candidate.defaults = with(candidate.defaults, none);
    input.rest = with(input.rest, none);
    inputs.push_back(std::move(input));
  }
  return inputs;
}

void Unroller::take_outputs(ContainerExecution& activation, StateIndex child, BranchEdge when,
                            std::vector<Symbol> outputs) {
  const mission::CompiledState& state = node(child);
  for (std::uint32_t i = 0; i < outputs.size(); ++i)
    store(activation, state.first_output + i, when, std::move(outputs[i]));
  for (const mission::SlotCopy& copy : state.into_variables)
    store(activation, copy.to, when, activation.slots.read(copy.from, when, paths_));
}

/// A value that would also count if `when` is off the path gets a Copy node on it.
void Unroller::store(ContainerExecution& activation, std::uint32_t slot, BranchEdge when, Symbol value) {
  const bool certain = paths_.implies(activation.entry.when, when);
  bool within = certain || planted(ConversionFault::SkipsCopies);
  if (!within) {
    within = !value.candidates.empty();
    bool one_is_certain = false;
    for (const Candidate& candidate : value.candidates) {
      const auto live = paths_.live(candidate.when);
      within = within && live && paths_.implies(*live, when);
      one_is_certain = one_is_certain || (live && *live == when);
    }
    within = within && one_is_certain;
  }
  activation.slots.write(slot, when, within ? std::move(value) : copied({&value, 1}, when), paths_);
}

/// The value that was written last to the slots. A null hides no older value of another slot; which of them
/// it is turns out when the plan runs.
Symbol Unroller::read(const ContainerExecution& activation, const std::vector<std::uint32_t>& slots,
                      BranchEdge at) {
  std::vector<Symbol> written;
  for (const std::uint32_t slot : slots) {
    Symbol one = activation.slots.read(slot, at, paths_);
    if (!one.empty()) written.push_back(std::move(one));
  }
  if (written.empty()) return {};
  return written.size() == 1 ? std::move(written.front()) : copied(written, at);
}

/// The newest of the values that is not null.
Symbol Unroller::copied(std::span<const Symbol> values, BranchEdge when) {
  PlannedNode planned = begin_structural(Role::Copy, when);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string name = std::string(kValueOutput) + (i == 0 ? "" : "." + std::to_string(i));
    planned.inputs.push_back(connect(spec_, values[i], name));
  }
  const NodeId id = append(spec_, std::move(planned), "copy");
  Symbol result;
  result.candidates.push_back({id, plan_.network_.names.intern(kValueOutput), when, {}});
  return result;
}

/// The edge that represents all the ways that lead to one state.
BranchEdge Unroller::meet(std::vector<BranchEdge> edges) {
  if (const auto one = paths_.merged(edges)) return *one;
  BranchEdge around = edges.front();
  for (const BranchEdge edge : edges)
    around = paths_.common(around, edge);
  return add_join(around, std::move(edges));
}

/// The edge that is on the path if `around` is, and one of the edges.
BranchEdge Unroller::add_join(BranchEdge around, std::vector<BranchEdge> edges) {
  PlannedNode planned = begin_structural(Role::Join, around);
  spec_.branches = true;
  const OutcomeId reached = plan_.network_.outcome("reached");
  const OutcomeId missed = plan_.network_.outcome("missed");
  spec_.expected = reached;
  const auto output = plan_.network_.names.intern(kOutcomeOutput);
  for (const BranchEdge edge : edges) {
    const auto input = plan_.network_.names.intern(numbered("way", planned.joined.size()));
    spec_.inputs.push_back({paths_.node(edge), output, input});
    planned.joined.emplace_back(input, edge.outcome);
  }
  const NodeId id = append(spec_, std::move(planned), "join");
  return paths_.add_join(id, around, std::move(edges), reached, missed);
}

/// The value, once it is known for certain.
std::optional<Value> Unroller::value_of(const Symbol& symbol) {
  for (auto candidate = symbol.candidates.rbegin(); candidate != symbol.candidates.rend(); ++candidate) {
    if (!paths_.live(candidate->when)) continue;
    const std::size_t i = index(candidate->node);
    if (i >= outputs_.size() || !outputs_[i]) {
      if (is_over(candidate->node)) continue;  // it lost a race before it began
      return std::nullopt;
    }
    const Value* value = outputs_[i]->find(plan_.network_.names.name(candidate->output));
    if (value == nullptr) continue;
    return with_defaults(*value, candidate->defaults, outputs_);
  }
  return with_defaults({}, symbol.rest, outputs_);
}

}  // namespace segue::convert
