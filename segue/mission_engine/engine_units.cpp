// SPDX-License-Identifier: Apache-2.0
//
// Whether an action may begin: its preconditions hold, and it has its units. Units that others hold are
// waited for; an action that needs more than there are aborts.
#include <segue/base/text.hpp>
#include <segue/mission_engine/engine_core.hpp>

#include <algorithm>
#include <functional>
#include <set>
#include <string>
#include <utility>

namespace segue::mission::detail {

using Phase = Activation::Phase;

/// Begins the leaf or container if it may, ends it if it never may, or else lets it wait.
Activation* EngineCore::ask(Activation& activation) {
  if (!look_up(activation)) {
    activation.asks = false;
    activation.refused = true;
    end_unit_wait(activation);
    return leave(activation, kAborted);
  }
  if (!take_units(activation, limits_for(activation))) {
    activation.phase = Phase::Wait;
    activation.asks = true;
    activation.effects.clear();
    asking_.emplace_back(&activation, activation.generation);
    note_unit_wait(activation);
    return nullptr;
  }
  activation.asks = false;
  end_unit_wait(activation);
  return is_leaf(program->node(activation.state).kind) ? begin_leaf(activation) : begin_container(activation);
}

/// Looks up the needs and changes of the state; false if it may not begin, with the reason as its error.
bool EngineCore::look_up(Activation& activation) {
  const Action& declared = *program->declared(activation.state);
  const std::string at = path(activation);
  auto own = needs(program->mission(), declared, activation.inputs, at, activation.around);
  if (!own) {
    activation.error = own.error().message;
    return false;
  }
  const auto is_known = [&](const GroundFact& fact) {
    return observer == nullptr || !is_observed(program->mission(), fact.text);
  };
  if (const GroundFact* lacking = world.first_false(own->preconditions, is_known)) {
    activation.error = precondition_error(*lacking);
    return false;
  }
  if (is_container(program->node(activation.state).kind))
    activation.inside = inside(*own, at, activation.around);
  activation.asked = std::move(own->uses);
  if (is_in_turn(activation, true)) {
    if (auto shortage = units.shortage(activation.asked)) {
      activation.error = std::move(*shortage);
      return false;
    }
  }
  if (lacks_lost_robot(activation)) {
    activation.error = robot_units_.lost;
    return false;
  }
  activation.effects = std::move(own->effects);
  activation.observed = std::move(own->observed);
  return true;
}

/// Who had begun in the run that this one resumes has its units. The journal does not say it of containers,
/// which count as such while it is replayed.
Units::Limits EngineCore::limits_for(const Activation& leaf) const {
  if (options.journal == nullptr || robot_units_.watched == nullptr) return Units::Limits::Heeded;
  const Execution execution{path(leaf), leaf.iteration};
  const bool had_begun =
      is_leaf(program->node(leaf.state).kind)
          ? options.journal->find(execution) || !options.journal->progress(execution).is_null()
          : replayed_count_ < options.journal->size();
  return had_begun ? Units::Limits::Passed : Units::Limits::Heeded;
}

bool EngineCore::take_units(Activation& leaf, Units::Limits limits) {
  if (leaf.asked.empty()) return true;
  if (!is_in_turn(leaf) || is_overtaking(leaf) || !units.take(leaf.asked, limits)) return false;
  leaf.units.uses = std::move(leaf.asked);
  if (!is_leaf(program->node(leaf.state).kind)) keep_blocked(leaf);
  return true;
}

/// A container goes on with what it blocks, which it lends to the states in it; the rest had to be there only
/// when it began.
void EngineCore::keep_blocked(Activation& container) {
  auto& uses = container.units.uses;
  const auto blocks = [](const UnitUse& use) { return use.operation == ResourceOperation::Block; };
  const auto others = std::stable_partition(uses.begin(), uses.end(), blocks);
  units.give_back(std::span(uses).subspan(static_cast<std::size_t>(others - uses.begin())), false);
  uses.erase(others, uses.end());
  for (const EnclosingScope::Held& held : lent_by(container))
    units.lend(held.taken, held.count, held.lent);
}

/// The units that the container itself has blocked and lends to the states in it.
std::span<const EnclosingScope::Held> EngineCore::lent_by(const Activation& container) {
  if (container.inside == container.around) return {};
  const std::size_t outer = container.around == nullptr ? 0 : container.around->held.size();
  return std::span(container.inside->held).first(container.inside->held.size() - outer);
}

/// For a step back into the container.
void EngineCore::hold_units_again(Activation& container, UnitsUsed& before) {
  container.asked = std::move(before.uses);
  if (!container.asked.empty()) take_units(container, Units::Limits::Passed);
}

void EngineCore::give_units_back(Activation& leaf) {
  const Action& declared = *program->declared(leaf.state);
  leaf.units.done = program->outcome_name(leaf.state, leaf.outcome) == declared.foreseen_outcome();
  for (const EnclosingScope::Held& held : lent_by(leaf))
    units.take_back(held.taken, held.count, held.lent);
  units.give_back(leaf.units.uses, leaf.units.done);
  if (!options.observe_units || leaf.begins_again) return;
  const UnitChanges changes = changes_by(leaf.units.uses, leaf.units.done);
  if (!changes.empty()) options.observe_units({path(leaf), leaf.iteration}, changes);
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
    const bool free = is_in_turn(leaf) && std::ranges::none_of(leaf.asked, overtakes) &&
                      units.are_free(leaf.asked, limits_for(leaf));
    const bool never = lacks_lost_robot(leaf) || (units.shortage(leaf.asked) && is_in_turn(leaf, true));
    if (!free && !never) {
      asking_.push_back(waiting);
      note_unit_wait(leaf);
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

/// Called when nothing can go on any more: units that are waited for are held by containers that wait
/// themselves. The first that waits aborts; false if nothing waits.
bool EngineCore::give_up_waiting() {
  for (const Waiting& waiting : asking_) {
    Activation& leaf = *waiting.first;
    if (leaf.generation != waiting.second || !leaf.asks) continue;
    const auto lacks = [this](const UnitUse& use) { return !units.are_free(std::span(&use, 1)); };
    const auto lacking = std::ranges::find_if(leaf.asked, lacks);
    const std::string& resource =
        lacking == leaf.asked.end() ? leaf.asked.front().resource : lacking->resource;
    leaf.error = "it waits for units of the resource " + quote(resource) +
                 ", which are held by a state that waits itself";
    leaf.asks = false;
    leaf.refused = true;
    ready_.push_back(leave(leaf, kAborted));
    return true;
  }
  return false;
}

/// Whether the leaf only waits until actions, which are under way, give units back. Then nobody else may take
/// these units before it does. A leaf that waits for a container keeps no units from others: the container
/// may need them to end. Nor does one that needs more than the robot shows, which may go on for ever.
bool EngineCore::only_lacks_held(const Activation& leaf) {
  return is_in_turn(leaf) && !units.shortage(leaf.asked) && !units.wait_for_container(leaf.asked) &&
         !units.exceed_limits(leaf.asked);
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

/// In a barrier, a leaf that uses units that come and go waits until the states before its own have begun
/// their last use of them; with `to_the_end`, until they have ended.
bool EngineCore::is_in_turn(const Activation& leaf, bool to_the_end) {
  if (!shared_.takes_in_order(leaf.state)) return true;
  const Activation* inner = &leaf;
  for (const Activation* around = leaf.parent; around != nullptr;
       inner = std::exchange(around, around->parent)) {
    if (program->node(around->state).kind != StateKind::Barrier) continue;
    for (const Activation* sibling : around->children) {
      if (sibling == inner) break;
      if (sibling->phase == Phase::Done || !shared_.shared(sibling->state, leaf.state)) continue;
      if (to_the_end || may_use_more(*sibling, leaf.state)) return false;
    }
  }
  return true;
}

/// Whether something may still begin in the state that shares such units with the user.
bool EngineCore::may_use_more(const Activation& state, StateIndex user) {
  std::vector<const Activation*> open = {&state};
  while (!open.empty()) {
    const Activation& next = *open.back();
    open.pop_back();
    const CompiledState& node = program->node(next.state);
    const bool begins = next.phase == Phase::Begin || next.asks;
    if (begins && shared_.shared(next.state, user)) return true;
    if (next.phase == Phase::Proceed && next.pending.kind == NextStep::Kind::Child) {
      const StateIndex child = node.children[next.pending.child];
      if (shared_.shared(child, user) || shared_.shared_after(child, user)) return true;
    }
    if (next.phase != Phase::Wait || is_leaf(node.kind)) continue;
    if (node.kind == StateKind::Barrier && next.open > 0 && shared_.shared(node.decider, user)) return true;
    for (const Activation* child : next.children) {
      if (node.kind == StateKind::Hierarchy && shared_.shared_after(child->state, user)) return true;
      open.push_back(child);
    }
  }
  return false;
}

}  // namespace segue::mission::detail
