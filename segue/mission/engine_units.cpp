// SPDX-License-Identifier: Apache-2.0
//
// Whether an action may begin: its preconditions hold, and it has its units. Units that others hold are
// waited for; an action that needs more than there are aborts.
#include <segue/mission/engine_core.hpp>

#include <algorithm>
#include <functional>
#include <set>
#include <string>
#include <utility>

namespace segue::mission::detail {

using Phase = Activation::Phase;

/// Begins the leaf if it may, ends it if it never may, or else lets it wait.
Activation* EngineCore::ask(Activation& leaf) {
  if (!look_up(leaf)) {
    leaf.asks = false;
    leaf.refused = true;
    return leave(leaf, kAborted);
  }
  if (!take_units(leaf)) {
    leaf.phase = Phase::Wait;
    leaf.asks = true;
    leaf.effects.clear();
    asking_.emplace_back(&leaf, leaf.generation);
    return nullptr;
  }
  leaf.asks = false;
  return begin_leaf(leaf);
}

/// What the action touches; false if it may not begin: the error of the leaf says why.
bool EngineCore::look_up(Activation& leaf) {
  const Action& action = program->mission().actions[program->node(leaf.state).action];
  auto touched = footprint(program->mission(), action, leaf.inputs, path(leaf));
  if (!touched) {
    leaf.error = touched.error().message;
    return false;
  }
  if (const GroundFact* lacking = world.first_false(touched->preconditions)) {
    leaf.error = precondition_error(*lacking);
    return false;
  }
  leaf.asked = unit_uses(action, std::move(touched->resources));
  if (is_in_turn(leaf, true)) {
    if (auto shortage = units.shortage(leaf.asked)) {
      leaf.error = std::move(*shortage);
      return false;
    }
  }
  leaf.effects = std::move(touched->effects);
  return true;
}

bool EngineCore::take_units(Activation& leaf) {
  if (leaf.asked.empty()) return true;
  if (!is_in_turn(leaf) || is_overtaking(leaf) || !units.take(leaf.asked)) return false;
  leaf.units.uses = std::move(leaf.asked);
  return true;
}

void EngineCore::give_units_back(Activation& leaf) {
  const Action& action = program->mission().actions[program->node(leaf.state).action];
  leaf.units.done = program->outcome_name(leaf.state, leaf.outcome) == action.foreseen_outcome();
  units.give_back(leaf.units.uses, leaf.units.done);
}

/// Called when nothing else can go on: begins those that can now; false if there are none. The others keep
/// their places, and nobody takes before them what they wait for.
bool EngineCore::ask_again() {
  bool any = false;
  std::set<std::string, std::less<>> wanted;
  for (const Waiting& waiting : std::exchange(asking_, {})) {
    Activation& leaf = *waiting.first;
    if (leaf.generation != waiting.second || !leaf.asks) continue;
    const auto overtakes = [&](const UnitUse& use) { return wanted.contains(use.resource); };
    const bool free =
        is_in_turn(leaf) && std::ranges::none_of(leaf.asked, overtakes) && units.are_free(leaf.asked);
    if (!free && !(units.shortage(leaf.asked) && is_in_turn(leaf, true))) {
      asking_.push_back(waiting);
      if (!only_lacks_held(leaf)) continue;
      for (const UnitUse& use : leaf.asked)
        wanted.insert(use.resource);
      continue;
    }
    if (Activation* next = ask(leaf)) ready_.push_back(next);
    if (leaf.asks) continue;
    any = true;
    if (leaf.item != History::kNone) history.begin_late(leaf.item, now());
  }
  return any;
}

/// Whether the leaf only waits until others, which are under way, give units back. What it then takes nobody
/// may take before.
bool EngineCore::only_lacks_held(const Activation& leaf) {
  return is_in_turn(leaf) && !units.shortage(leaf.asked);
}

/// Whether a leaf that has waited longer needs the same resource, and only waits until it is free.
bool EngineCore::is_overtaking(const Activation& leaf) {
  return std::ranges::any_of(asking_, [&](const Waiting& waiting) {
    const Activation& other = *waiting.first;
    if (other.generation != waiting.second || !other.asks || !only_lacks_held(other)) return false;
    return std::ranges::any_of(other.asked, [&](const UnitUse& use) {
      return std::ranges::find(leaf.asked, use.resource, &UnitUse::resource) != leaf.asked.end();
    });
  });
}

/// In a barrier, who uses units that come and go waits until the states before its own have begun their last
/// use of them; with `to_the_end`, until they have ended.
bool EngineCore::is_in_turn(const Activation& leaf, bool to_the_end) {
  const std::uint32_t action = program->node(leaf.state).action;
  if (!shared_.takes_in_order(action)) return true;
  const Activation* inner = &leaf;
  for (const Activation* around = leaf.parent; around != nullptr;
       inner = std::exchange(around, around->parent)) {
    if (program->node(around->state).kind != StateKind::Barrier) continue;
    for (const Activation* sibling : around->children) {
      if (sibling == inner) break;
      if (sibling->phase == Phase::Done || !shared_.shared(sibling->state, action)) continue;
      if (to_the_end || may_use_more(*sibling, action)) return false;
    }
  }
  return true;
}

/// Whether an action may still begin in the state that shares such units with this one.
bool EngineCore::may_use_more(const Activation& state, std::uint32_t action) {
  std::vector<const Activation*> open = {&state};
  while (!open.empty()) {
    const Activation& next = *open.back();
    open.pop_back();
    const CompiledState& node = program->node(next.state);
    const bool begins = next.phase == Phase::Begin || next.asks;
    if (begins && shared_.shared(next.state, action)) return true;
    if (next.phase == Phase::Proceed && next.pending.kind == NextStep::Kind::Child) {
      const StateIndex child = node.children[next.pending.child];
      if (shared_.shared(child, action) || shared_.shared_after(child, action)) return true;
    }
    if (next.phase != Phase::Wait || is_leaf(node.kind)) continue;
    if (node.kind == StateKind::Barrier && next.open > 0 && shared_.shared(node.decider, action)) return true;
    for (const Activation* child : next.children) {
      if (node.kind == StateKind::Hierarchy && shared_.shared_after(child->state, action)) return true;
      open.push_back(child);
    }
  }
  return false;
}

}  // namespace segue::mission::detail
