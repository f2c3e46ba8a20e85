// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/base/utf8.hpp>
#include <segue/mission_engine/engine_core.hpp>
#include <segue/type/json.hpp>

#include <algorithm>

namespace segue::mission::detail {

using Phase = Activation::Phase;
using type::Value;
using type::ValueMap;

namespace {

/// The most that is shown of one value: items of a list or map, and characters.
constexpr std::size_t kMostItems = 20;
constexpr std::size_t kLongestText = 1000;

/// A copy that is small however large the value is; `left` counts down what may still be copied.
Value cut_value(const Value& value, std::size_t& left, bool& is_cut) {
  if (left == 0) {
    is_cut = true;
    return {};
  }
  --left;
  if (value.is_list()) {
    Value::List list;
    const auto& items = value.as_list();
    is_cut = is_cut || items.size() > kMostItems;
    for (std::size_t i = 0; i < std::min(items.size(), kMostItems) && left > 0; ++i)
      list.push_back(cut_value(items[i], left, is_cut));
    return list;
  }
  if (value.is_map()) {
    ValueMap map;
    is_cut = is_cut || value.as_map().size() > kMostItems;
    for (const auto& [key, item] : value.as_map()) {
      if (map.size() == kMostItems || left == 0) break;
      map.append(std::string(beginning_of(key, kLongestText)), cut_value(item, left, is_cut));
    }
    return map;
  }
  if (value.is_string() && value.as_string().size() > kLongestText) {
    is_cut = true;
    return std::string(beginning_of(value.as_string(), kLongestText));
  }
  return value;
}

Value shown(const Port& port, const Value& value) {
  bool is_cut = false;
  std::size_t left = kMostItems * 10;
  std::string text = type::to_json(cut_value(value, left, is_cut), -1);
  if (text.size() > kLongestText) {
    is_cut = true;
    text.resize(beginning_of(text, kLongestText).size());
  }
  ValueMap map;
  map.append("name", port.name);
  map.append("type", port.type);
  map.append("text", std::move(text));
  if (is_cut) map.append("cut", true);
  return map;
}

Value shown(const std::vector<Port>& ports, const std::vector<Value>& values) {
  Value::List list;
  for (std::size_t i = 0; i < std::min(ports.size(), values.size()); ++i)
    list.push_back(shown(ports[i], values[i]));
  return list;
}

/// The child of a hierarchy, or the concurrent state, that has begun and not ended.
Activation* active_child(const Activation& container, StateIndex state) {
  for (Activation* child : container.children) {
    if (child->state == state && child->phase != Phase::Done) return child;
  }
  return nullptr;
}

/// A library hands its inputs to its root.
const std::vector<Value>& inputs_of(const Program& program, const Activation& activation) {
  const Activation* at = &activation;
  while (at->inputs.empty() && program.node(at->state).kind == StateKind::Library && !at->children.empty())
    at = at->children.front();
  return at->inputs;
}

Value last_outputs(const CompiledState& node, const Activation& container) {
  Value::List outputs;
  for (std::size_t i = 0; i < node.output_ports->size(); ++i) {
    const Slot& slot = container.slots[node.first_output + i];
    if (slot.stamp > 0) outputs.push_back(shown((*node.output_ports)[i], slot.value));
  }
  return outputs;
}

}  // namespace

/// The innermost container on the path that runs, no deeper than `depth` states; and how many states on the
/// path lead to it.
std::pair<Activation*, std::size_t> EngineCore::innermost(const Path& path, std::size_t depth) const {
  const auto inside_libraries = [&](Activation* at) {
    while (at != nullptr && program->node(at->state).kind == StateKind::Library)
      at = at->children.empty() ? nullptr : at->children.front();
    return at;
  };
  Activation* at = inside_libraries(root_);
  std::size_t i = 0;
  while (at != nullptr && i < depth) {
    Activation* next = inside_libraries(active_child(*at, path[i]));
    if (next == nullptr) break;
    at = next;
    ++i;
  }
  return {at, i};
}

Result<void> EngineCore::go_on_at(const Path& path) {
  if (options.journal != nullptr) {
    return fail(
        ErrorCode::Unsupported,
        "a run with a journal goes on in its order, so that it can be resumed; it cannot be told to go on "
        "elsewhere");
  }
  const auto [at, depth] = innermost(path, path.size() - 1);
  if (at == nullptr) return fail(ErrorCode::InvalidState, "the mission has not begun");
  for (std::size_t i = depth; i < path.size(); ++i) {
    const CompiledState& around = program->node(program->node(path[i]).parent);
    if (is_concurrency(around.kind)) {
      return fail(ErrorCode::Unsupported, quote(program->state(path[i]).id.str()) +
                                              " begins together with the states beside it; go on at the "
                                              "container of them, or in one of them that runs");
    }
  }
  if (at->preempted) return fail(ErrorCode::InvalidState, "what is around that state is being preempted");
  std::vector<StateIndex> rest(path.rbegin(), path.rend() - static_cast<std::ptrdiff_t>(depth));
  if (mode_ == Mode::Marked) mode_ = Mode::Hold;
  if (at->phase == Phase::Begin || at->asks) {
    start_path = std::move(rest);
    return {};
  }
  jump_ = Jump{at, at->generation, std::move(rest)};
  if (at->children.empty()) {
    (void)take_jump(*at);
    if (at->held) let_go(*at);
    return {};
  }
  preempt(*at->children.front());
  return {};
}

/// Whether the hierarchy was told where to go on, which is then its next step.
bool EngineCore::take_jump(Activation& hierarchy) {
  if (!jump_ || jump_->at != &hierarchy) return false;
  const Jump jump = std::move(*std::exchange(jump_, std::nullopt));
  if (jump.generation != hierarchy.generation || hierarchy.preempted) return false;
  start_path = jump.path;
  hierarchy.pending = {NextStep::Kind::Child, program->node(start_path.back()).position, 0};
  start_path.pop_back();
  hierarchy.phase = Phase::Proceed;
  hierarchy.last = 0;
  hierarchy.error.clear();
  hierarchy.pass = !start_path.empty();
  forget_done(hierarchy);
  return true;
}

/// Forgets the steps back in the hierarchy and around it: the mission cannot step back over a preempted
/// state.
void EngineCore::forget_done(Activation& hierarchy) {
  for (Activation* around = &hierarchy; around != nullptr; around = around->parent) {
    for (const UndoRecord& record : std::exchange(around->undo, {})) {
      if (record.kept != nullptr) forget(*record.kept);
    }
  }
}

type::Value EngineCore::values_of(const Path& path) {
  Value::List none;
  ValueMap map;
  if (path.empty()) {
    const CompiledState& node = program->node(0);
    map.append("when", root_ == nullptr || ended ? "" : "running");
    map.append("inputs", root_ == nullptr || ended ? Value(none) : shown(*node.input_ports, root_->inputs));
    map.append("outputs", ended ? shown(*node.output_ports, result.outputs) : Value(none));
    return map;
  }
  const auto [container, depth] =
      ended ? std::pair<Activation*, std::size_t>{} : innermost(path, path.size() - 1);
  const bool is_there = container != nullptr && depth + 1 == path.size() && container->phase != Phase::Begin;
  if (!is_there) {
    map.append("when", "");
    map.append("inputs", none);
    map.append("outputs", none);
    return map;
  }
  const CompiledState& node = program->node(path.back());
  const auto begun = std::ranges::find(container->children, path.back(), &Activation::state);
  const Activation* child = begun == container->children.end() ? nullptr : *begun;
  const bool has_ended = child != nullptr && child->phase == Phase::Done;
  const bool runs = child != nullptr && !has_ended && !(child->held && child->phase == Phase::Begin);
  map.append("when", has_ended ? "ended" : runs ? "running" : "next");
  map.append("inputs", shown(*node.input_ports,
                             child != nullptr ? inputs_of(*program, *child) : next_inputs(node, *container)));
  map.append("outputs",
             has_ended ? shown(*node.output_ports, child->outputs) : last_outputs(node, *container));
  return map;
}

std::vector<Value> EngineCore::next_inputs(const CompiledState& node, const Activation& container) {
  std::vector<Value> inputs;
  for (const PortSource& supply : node.inputs) {
    const Slot* slot = newest(supply, container);
    const bool is_global = slot == nullptr && !supply.global.empty();
    inputs.push_back(slot != nullptr ? slot->value
                     : is_global     ? globals.get(supply.global).value_or(Value())
                                     : supply.fallback);
  }
  return inputs;
}

}  // namespace segue::mission::detail
